"""A fence around this process and all it starts: Linux's Landlock, which needs no rights and binds root as well.

Behind it files can be changed in the given folders only, and signals, traces and abstract sockets reach only processes
behind the same fence. Reading stays as it was. On systems without it there is no fence, and `height` is 0.
"""

from __future__ import annotations

import ctypes
import os
import stat
import struct
import sys
from collections.abc import Sequence

_CREATE, _ADD, _RESTRICT = 444, 445, 446
_VERSION, _BENEATH, _NO_NEW_PRIVILEGES = 1, 1, 38
_WRITE, _TRUNCATE = 1 << 1, 1 << 14
_CHANGES = _WRITE | sum(1 << k for k in range(4, 13))  # remove and make whatever there is
_REFER = 1 << 13
_SCOPES = 0b11  # abstract sockets, signals
_ALWAYS = ("/dev/null", "/dev/zero", "/dev/full", "/dev/tty", "/dev/shm")


def height() -> int:
    """The version of Landlock, 0 without it; version 6 and later hold back signals too."""
    return max(0, _call(_CREATE, None, 0, _VERSION)) if sys.platform == "linux" else 0


def fence(writable: Sequence[str]) -> None:
    """Put this process behind the fence for good, if there is one; raises OSError if it cannot be closed."""
    version = height()
    if version == 0:
        return
    rights = _CHANGES | (_REFER if version >= 2 else 0) | (_TRUNCATE if version >= 3 else 0)
    room = struct.pack("QQQ", rights, 0, _SCOPES if version >= 6 else 0)[: _size(version)]
    rules = _must(_call(_CREATE, room, len(room), 0))
    for path in (*_ALWAYS, *writable):
        _allow(rules, path, rights)
    _must(ctypes.CDLL(None, use_errno=True).prctl(_NO_NEW_PRIVILEGES, 1, 0, 0, 0))
    _must(_call(_RESTRICT, rules, 0))
    os.close(rules)


def _size(version: int) -> int:
    """How many bytes of the rights that version knows."""
    return 24 if version >= 6 else 16 if version >= 4 else 8


def _allow(rules: int, path: str, rights: int) -> None:
    try:
        place = os.open(path, os.O_PATH | os.O_CLOEXEC)
    except OSError:
        return
    try:
        folder = stat.S_ISDIR(os.fstat(place).st_mode)
        allowed = rights if folder else rights & (_WRITE | _TRUNCATE)
        _must(_call(_ADD, rules, _BENEATH, struct.pack("=Qi", allowed, place), 0))
    finally:
        os.close(place)


def _call(number: int, *arguments: object) -> int:
    given = [ctypes.c_long(argument) if isinstance(argument, int) else argument for argument in arguments]
    return int(ctypes.CDLL(None, use_errno=True).syscall(ctypes.c_long(number), *given))


def _must(answer: int) -> int:
    if answer < 0:
        number = ctypes.get_errno()
        raise OSError(number, os.strerror(number))
    return answer
