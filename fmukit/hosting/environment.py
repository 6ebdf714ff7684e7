"""What a host that is not Python needs to run the FMUs, and whether this machine has it.

PythonFMU's binary calls the Python interpreter but is not linked to it: it expects the interpreter's symbols in the
process. Under Linux a host that is no Python program gets them by preloading libpython. The interpreter then looks for
`python3` on PATH to learn which environment it belongs to.
"""

from __future__ import annotations

import os
import platform
import struct
import sys
import sysconfig
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from fmukit.compiling import compiler
from fmukit.errors import BuildError
from fmukit.store import cache_folder

_MACHINES = ("x86_64", "amd64")
_SYSTEMS = ("Linux", "Windows")


@dataclass(frozen=True, slots=True)
class Finding:
    """One thing that is there or missing; `seen` is what was found, `remedy` how to get it."""

    thing: str
    there: bool
    seen: str
    remedy: str = ""


def environment(base: Mapping[str, str]) -> dict[str, str]:
    """`base` completed with what a foreign host needs; variables that are set already keep their value at the end.

    PATH starts with the folder of this interpreter. Under Linux LD_PRELOAD starts with libpython, and LD_LIBRARY_PATH
    with this environment's lib folder, where wheels put libraries such as tbb; under Windows PATH also has the folder
    of python3.dll.
    """
    made = dict(base)
    _prepend(made, "PATH", str(Path(sys.executable).parent))
    if sys.platform == "win32":
        _prepend(made, "PATH", sys.base_prefix)
        return made
    _prepend(made, "LD_LIBRARY_PATH", str(Path(sys.prefix) / "lib"))
    library = libpython()
    if library is not None:
        _prepend(made, "LD_PRELOAD", str(library))
    return made


def libpython() -> Path | None:
    """The shared library of this very interpreter, or None if there is none."""
    return next((path for path in _library_places() if path.is_file()), None)


def _library_places() -> list[Path]:
    major, minor = sys.version_info[:2]
    if sys.platform == "win32":
        return [Path(sys.base_prefix, f"python{major}{minor}.dll")]
    folder, name, multiarch = (sysconfig.get_config_var(key) or "" for key in ("LIBDIR", "INSTSONAME", "MULTIARCH"))
    if ".so" not in name:  # the interpreter is linked statically, but the library may be there nevertheless
        name = f"libpython{major}.{minor}.so.1.0"
    return [Path(folder, name), Path(folder, multiarch, name), Path(sys.base_prefix, "lib", name)]


def findings() -> Iterator[Finding]:
    """Everything needed to build the FMUs and to run them in any host, one after the other."""
    yield _platform()
    yield _compiler()
    yield _libpython()
    yield _cache()


def _platform() -> Finding:
    system, machine, bits = platform.system(), platform.machine(), 8 * struct.calcsize("P")
    there = system in _SYSTEMS and machine.lower() in _MACHINES and bits == 64
    remedy = "the FMUs have libraries for 64-bit Linux and Windows on x86; run there, or in a container (docker)"
    return Finding("platform", there, f"{system} {machine}, {bits}-bit Python {platform.python_version()}", remedy)


def _compiler() -> Finding:
    """A compiler that really makes a shared library."""
    remedy = "install gcc or clang (Debian: apt install gcc libc6-dev), or pip install ziglang"
    try:
        with tempfile.TemporaryDirectory(prefix="fmus-") as name:
            Path(name, "shim.c").write_text("int one(void) { return 1; }\n", "utf-8")
            compiler.run(Path(name), compiler.host_platform())
        return Finding("compiler", True, " ".join(compiler.command(compiler.host_platform())))
    except (BuildError, OSError) as error:
        return Finding("compiler", False, str(error), remedy)


def _libpython() -> Finding:
    library = libpython()
    version = f"{sys.version_info[0]}.{sys.version_info[1]}"
    remedy = (
        f"hosts written in Python need none; for others use a Python with a shared library: Debian: apt install "
        f"libpython{version}; pyenv: PYTHON_CONFIGURE_OPTS=--enable-shared pyenv install {version}"
    )
    return Finding("libpython", library is not None, str(library or f"none for {sys.executable}"), remedy)


def _cache() -> Finding:
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"x")
        return Finding("cache folder", True, str(folder))
    except OSError as error:
        remedy = "make it writable, free some space, or name another place in XDG_CACHE_HOME"
        return Finding("cache folder", False, f"{folder}: {error.strerror or error}", remedy)


def _prepend(variables: dict[str, str], name: str, value: str) -> None:
    variables[name] = os.pathsep.join(filter(None, [value, variables.get(name, "")]))
