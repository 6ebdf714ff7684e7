"""What goes between the master and an instance in a process of its own.

Numbers lie in memory that both sides map; a socket carries the calls. A request is one byte: EXCHANGE (set, step and
get), SET or GET, or CONTROL, which a pickled call follows. An answer is one byte, an fmi2Status; with MORE added to it
a JSON object follows. Nothing that comes from the FMU's side is ever unpickled.
"""

from __future__ import annotations

import json
import mmap
import os
import socket
import struct
import sys
import tempfile
from typing import Any

import numpy as np

from cosim.model.signals import Vector

EXCHANGE, SET, GET, CONTROL = b"x", b"s", b"g", b"c"
MORE = 0x40
CALLS = ("fmi2Instantiate", "fmi2SetReal", "fmi2DoStep", "fmi2GetReal", "{}")
"""What the first byte of the memory says is under way, by its value; the last one stands for any other call."""
MOST = 1 << 28
"""Bytes of an answer at most."""
_LENGTH = struct.Struct("<I")
_HEAD = 3


class Cut(Exception):  # noqa: N818  (what happened to the other side)
    """The other side has closed the channel."""


class Garbled(Exception):  # noqa: N818
    """What the other side has said is no answer."""


def memory_file() -> int:
    """The descriptor of an empty file without a name, which on Linux can only grow.

    Who touches mapped memory whose file has become shorter is ended by the system; an FMU must not do that to others.
    """
    if sys.platform == "linux":
        import fcntl  # noqa: PLC0415  (not on every platform)

        descriptor = os.memfd_create("cosim", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        fcntl.fcntl(descriptor, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK)
        return descriptor
    with tempfile.TemporaryFile() as file:
        return os.dup(file.fileno())


class Shared:
    """The memory of one instance with `inputs` and `outputs` numbers: `clock` holds time and step [s], `u` and `y`."""

    def __init__(self, descriptor: int, inputs: int = 0, outputs: int = 0) -> None:
        size = 8 * (_HEAD + inputs + outputs)
        if os.fstat(descriptor).st_size < size:
            os.ftruncate(descriptor, size)
        self._mapped = mmap.mmap(descriptor, size)
        self.mark = memoryview(self._mapped)[:1]
        values: Vector = np.frombuffer(self._mapped)
        self.clock, self.u, self.y = values[1:_HEAD], values[_HEAD : _HEAD + inputs], values[_HEAD + inputs :]


def send(to: socket.socket, head: bytes, payload: bytes) -> None:
    """One message with a payload."""
    to.sendall(head + _LENGTH.pack(len(payload)) + payload)


def receive(source: socket.socket) -> bytes:
    """The payload of a message whose first byte has been read; raises Cut or Garbled."""
    (length,) = _LENGTH.unpack(_exactly(source, _LENGTH.size))
    if length > MOST:
        raise Garbled
    return _exactly(source, length)


def answer(to: socket.socket, status: int, more: dict[str, Any]) -> None:
    """An answer with more than a status."""
    send(to, bytes([status | MORE]), json.dumps(more).encode())


def more_of(source: socket.socket) -> dict[str, Any]:
    """What follows a status with MORE; raises Cut or Garbled."""
    try:
        found = json.loads(receive(source))
    except ValueError:
        raise Garbled from None
    if not isinstance(found, dict):
        raise Garbled
    return found


def _exactly(source: socket.socket, length: int) -> bytes:
    data = bytearray(length)
    view = memoryview(data)
    while view:
        got = source.recv_into(view)
        if not got:
            raise Cut
        view = view[got:]
    return bytes(data)
