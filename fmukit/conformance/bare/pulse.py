"""Which call of the FMU a process is in: a small file that whoever waits for the process can read at any time."""

from __future__ import annotations

import mmap
import os
import struct
from pathlib import Path

PLACE = "FMUS_CHECK_PULSE"
"""The environment variable that names the file."""
_SIZE = 64
_FORM = struct.Struct(f"Q{_SIZE - 8}s")


class Pulse:
    """The writing side."""

    def __init__(self, path: str) -> None:
        with open(path, "r+b") as file:
            self._memory = mmap.mmap(file.fileno(), _SIZE)

    def beat(self, call: str) -> None:
        """A call begins; "" when it has returned."""
        count, _ = _FORM.unpack_from(self._memory)
        _FORM.pack_into(self._memory, 0, (count + 1) % 2**64, call.encode())


def prepare(path: Path) -> None:
    """Make the file."""
    path.write_bytes(bytes(_SIZE))


def read(path: Path) -> tuple[int, str]:
    """How many beats there were, and the call that has not returned, "" if there is none; nobody's word if damaged."""
    try:
        count, call = _FORM.unpack(path.read_bytes()[:_SIZE])
    except (OSError, struct.error):
        return 0, ""
    return int(count), call.rstrip(b"\0").decode("ascii", "replace")


def own() -> Pulse | None:
    """The pulse of this process, if the environment names one."""
    return Pulse(os.environ[PLACE]) if os.path.isfile(os.environ.get(PLACE, "")) else None
