"""Leave the process in peace: PythonFMU 0.7.0 releases its interpreter state twice when a Linux process ends.

The binary's static destructor frees the state, then its library destructor decrements the count in the freed memory;
now and then the process aborts after all its work is done ("corrupted unsorted chunks"). The library destructor called
first, while the state is alive, leaves nothing for the other two to do.
"""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from pathlib import Path

_done: set[str] = set()


def release_interpreter_once(binary: Path) -> None:
    """Let the exit of the process begin with PythonFMU's own release function, where the platform has this fault."""
    key = str(binary)
    if not sys.platform.startswith("linux") or key in _done or not binary.is_file():
        return
    _done.add(key)
    with suppress(OSError, AttributeError):  # without that function, or the C library's, there is nothing to do
        release = ctypes.cast(ctypes.CDLL(key).finalizePythonInterpreter, ctypes.c_void_p)
        register = ctypes.CDLL(None).__cxa_atexit
        register.argtypes = [ctypes.c_void_p] * 3
        register(release, None, None)
