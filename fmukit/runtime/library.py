"""The compiled kernel: loaded with the first instance that needs it, released with the last."""

from __future__ import annotations

import _ctypes
import ctypes
import sys
import threading
import weakref
from pathlib import Path

from .shared import Shared

FILE = {"win32": "kernel.dll", "darwin": "kernel.dylib"}.get(sys.platform, "kernel.so")
_PROTOTYPES = {
    "fmukit_initialise": (ctypes.c_void_p, ctypes.c_int64, ctypes.c_void_p, ctypes.c_double),
    "fmukit_sample": (ctypes.c_void_p, ctypes.c_int64, ctypes.c_int64, ctypes.c_double),
    "fmukit_advance": (ctypes.c_void_p, ctypes.c_double, ctypes.c_int64),
    "fmukit_store": (ctypes.c_void_p, ctypes.c_void_p),
    "fmukit_size": (),
}


class LibraryError(Exception):
    """The kernel library cannot be used; the message is a sentence for the user."""


def load(path: Path, size: int, user: object) -> ctypes.PyDLL:
    """The library at `path` for one more user, whose buffer has `size` doubles; let go when the user is no more.

    The last user's end unloads the library, so that its file can be deleted. PyDLL keeps the GIL: the kernel's scratch
    memory is static and shared by all instances of the process.
    """
    library: ctypes.PyDLL = _loaded.take(str(path), lambda: _open(path))
    if library.fmukit_size() != size:
        _loaded.give_back(str(path))
        raise LibraryError(f"{path.name} does not belong to this FMU; unpack the FMU again")
    weakref.finalize(user, _loaded.give_back, str(path)).atexit = False
    return library


def _unload(library: ctypes.PyDLL) -> None:
    if sys.platform == "win32":
        _ctypes.FreeLibrary(library._handle)
    else:
        _ctypes.dlclose(library._handle)


def _open(path: Path) -> ctypes.PyDLL:
    if not path.is_file():
        raise LibraryError(f"this FMU has no kernel for {sys.platform} ({path.name}); build it for this platform")
    try:
        library = ctypes.PyDLL(str(path))
    except OSError as error:
        raise LibraryError(f"{path.name} cannot be loaded ({error}); build the FMU for this platform") from error
    for name, arguments in _PROTOTYPES.items():
        function = getattr(library, name, None)
        if function is not None:
            function.argtypes, function.restype = list(arguments), ctypes.c_int
    return library


_loaded = Shared(threading.RLock(), _unload)
