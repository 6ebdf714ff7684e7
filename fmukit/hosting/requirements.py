"""What building the FMUs and running them in any host needs, and whether this machine has it."""

from __future__ import annotations

import platform
import struct
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from fmukit.compiling import compiler
from fmukit.errors import BuildError
from fmukit.hosting.environment import libpython
from fmukit.places import is_plain
from fmukit.store import cache_folder

_MACHINES = ("x86_64", "amd64")
_SYSTEMS = ("Linux", "Windows")


@dataclass(frozen=True, slots=True)
class Requirement:
    """One thing that building or running FMUs needs; `seen` is what was found, `remedy` how to get it."""

    thing: str
    there: bool
    seen: str
    remedy: str = ""


def requirements() -> Iterator[Requirement]:
    """Everything needed to build the FMUs and to run them in any host, one after the other."""
    yield _platform()
    yield _compiler()
    yield _libpython()
    yield _cache()
    yield _temporary()


def _platform() -> Requirement:
    system, machine, bits = platform.system(), platform.machine(), 8 * struct.calcsize("P")
    there = system in _SYSTEMS and machine.lower() in _MACHINES and bits == 64
    remedy = "the FMUs have libraries for 64-bit Linux and Windows on x86; run there, or in a container (docker)"
    return Requirement("platform", there, f"{system} {machine}, {bits}-bit Python {platform.python_version()}", remedy)


def _compiler() -> Requirement:
    """A compiler that really makes a shared library."""
    remedy = "install gcc or clang (Debian: apt install gcc libc6-dev), or pip install ziglang"
    try:
        with tempfile.TemporaryDirectory(prefix="fmus-") as name:
            Path(name, "shim.c").write_text("int one(void) { return 1; }\n", "utf-8")
            compiler.run(Path(name), compiler.host_platform())
        return Requirement("compiler", True, " ".join(compiler.command(compiler.host_platform())))
    except (BuildError, OSError) as error:
        return Requirement("compiler", False, str(error), remedy)


def _libpython() -> Requirement:
    library = libpython()
    version = f"{sys.version_info[0]}.{sys.version_info[1]}"
    remedy = (
        f"hosts written in Python need none; for others use a Python with a shared library: Debian: apt install "
        f"libpython{version}; pyenv: PYTHON_CONFIGURE_OPTS=--enable-shared pyenv install {version}"
    )
    return Requirement("libpython", library is not None, str(library or f"none for {sys.executable}"), remedy)


def _temporary() -> Requirement:
    folder = Path(tempfile.gettempdir())
    remedy = "set TMPDIR (Windows: TEMP) to a path of plain letters; `cosim` and `fmus` go elsewhere, other hosts crash"
    return Requirement("temporary", is_plain(folder), str(folder), remedy)


def _cache() -> Requirement:
    folder = cache_folder()
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"x")
        return Requirement("cache folder", True, str(folder))
    except OSError as error:
        remedy = "make it writable, free some space, or name another place in XDG_CACHE_HOME"
        return Requirement("cache folder", False, f"{folder}: {error.strerror or error}", remedy)
