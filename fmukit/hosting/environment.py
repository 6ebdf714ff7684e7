"""The environment in which a host that is not Python can run the FMUs.

PythonFMU's binary calls the Python interpreter but is not linked to it: it expects the interpreter's symbols in the
process. Under Linux a host that is no Python program gets them by preloading libpython. The interpreter then looks for
`python3` on PATH to learn which environment it belongs to.
"""

from __future__ import annotations

import os
import sys
import sysconfig
from collections.abc import Mapping
from pathlib import Path


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
    return next((path for path in library_places() if path.is_file()), None)


def library_places() -> list[Path]:
    """Where the shared library of this interpreter may lie."""
    major, minor = sys.version_info[:2]
    if sys.platform == "win32":
        return [Path(sys.base_prefix, f"python{major}{minor}.dll")]
    folder, name, multiarch = (sysconfig.get_config_var(key) or "" for key in ("LIBDIR", "INSTSONAME", "MULTIARCH"))
    if ".so" not in name:  # the interpreter is linked statically, but the library may be there nevertheless
        name = f"libpython{major}.{minor}.so.1.0"
    return [Path(folder, name), Path(folder, multiarch, name), Path(sys.base_prefix, "lib", name)]


def _prepend(variables: dict[str, str], name: str, value: str) -> None:
    variables[name] = os.pathsep.join(filter(None, [value, variables.get(name, "")]))
