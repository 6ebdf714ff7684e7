"""A C compiler: `$CC`, else `cc`, else the `ziglang` wheel, which also makes Windows libraries.

The flags keep IEEE arithmetic as written (no contraction, no reassociation, no instructions beyond the platform's
baseline), so that a kernel gives the same bits as CasADi's own evaluation and on every machine of the platform.
"""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from importlib.util import find_spec
from pathlib import Path

from fmukit.errors import BuildError

PLATFORMS = {"linux64": "kernel.so", "win64": "kernel.dll"}
_TARGETS = {"linux64": "x86_64-linux-gnu.2.28", "win64": "x86_64-windows-gnu"}
_FLAGS = ("-std=c11", "-O2", "-fno-math-errno", "-fno-trapping-math", "-ffp-contract=off", "-w", "-s", "-shared")
_LINUX = ("-fPIC", "-fvisibility=hidden", "-Wl,--build-id=none", "-Wl,--as-needed")


def host_platform() -> str:
    """The FMI name of the platform this process runs on."""
    return "win64" if sys.platform == "win32" else "linux64"


@cache
def command(platform: str) -> tuple[str, ...]:
    """The compiler for `platform`; raises BuildError saying how to get one."""
    if platform not in PLATFORMS:
        raise BuildError(f"there is no platform {platform}; choose from {', '.join(PLATFORMS)}")
    if platform == host_platform():
        own = native()
        if own:
            return own
    if find_spec("ziglang"):
        return (sys.executable, "-m", "ziglang", "cc", "-target", _TARGETS[platform])
    need = "a C compiler" if platform == host_platform() else f"the ziglang package (to build for {platform})"
    others = "install gcc or clang, set CC, or " if platform == host_platform() else ""
    raise BuildError(f"building an FMU needs {need}: {others}run `pip install ziglang`")


def native() -> tuple[str, ...] | None:
    """The machine's own compiler, None if it has none; raises BuildError when CC names one that does not exist."""
    chosen = shlex.split(os.environ.get("CC", ""))
    if chosen:
        if shutil.which(chosen[0]) is None:
            raise BuildError(f"the compiler CC={os.environ['CC']} does not exist; correct or unset CC")
        return tuple(chosen)
    return ("cc",) if shutil.which("cc") else None


@cache
def identity(platform: str) -> str:
    """Which compiler with which flags: part of the key of everything compiled."""
    compiler = command(platform)
    try:
        version = subprocess.run([*compiler, "--version"], capture_output=True, text=True, timeout=60, check=False)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise BuildError(f"the compiler {' '.join(compiler)} does not run ({error}); correct or unset CC") from error
    return "\n".join([*compiler, *flags(platform), version.stdout])


def flags(platform: str) -> tuple[str, ...]:
    """The flags every kernel for `platform` is compiled with."""
    return (*_FLAGS, *(_LINUX if platform == "linux64" else ()))


def run(folder: Path, platform: str, units: Sequence[str] = ("shim.c",), extra: Sequence[str] = ()) -> bytes:
    """Compile the `units` in `folder` into a shared library and return it. Names are relative: no path gets into it.

    `extra` flags come last and so prevail.
    """
    library = PLATFORMS[platform]
    libraries = ("-lm",) if platform == "linux64" else ()
    line = [*command(platform), *flags(platform), *extra, "-o", library, *units, *libraries]
    done = subprocess.run(line, cwd=folder, capture_output=True, text=True, check=False)
    made = folder / library
    if done.returncode or not made.is_file():
        said = (done.stderr.strip().splitlines() or [f"status {done.returncode}, no message, no library"])[0]
        raise BuildError(f"the compiler {' '.join(command(platform))} failed ({said}); {_remedy()}")
    return made.read_bytes()


def _remedy() -> str:
    return "correct or unset CC" if os.environ.get("CC") else "set CC to one that works"
