"""The complete state of an instance, and its form as bytes. No pickle: bytes from a stranger must not run code."""

from __future__ import annotations

import json
import struct
from array import array
from dataclasses import dataclass
from hashlib import blake2b
from math import isfinite

from .description import Description

_MAGIC = b"FMUKIT\x00\x01"
_HEAD = struct.Struct("<8s16sB4?qddQQ")
_DIGEST = 16


@dataclass(frozen=True, slots=True)
class Snapshot:
    """`buffer` holds all doubles; the rest is what the slave keeps beside it.

    Not a tuple: PythonFMU would unpack it into several arguments.
    """

    buffer: bytes
    strings: tuple[tuple[int, str], ...]
    mode: int
    dirty: bool
    pending: bool
    broken: bool
    anchored: bool
    samples: int
    origin: float
    time: float


@dataclass(frozen=True, slots=True)
class Refused:
    """What deserialising gives instead of a snapshot when the bytes are not sound."""

    reason: str


def to_bytes(snapshot: Snapshot, description: Description) -> bytes:
    """The snapshot with the hash of its FMU's package, which alone can read it back."""
    text = json.dumps(snapshot.strings).encode("utf-8")
    head = _HEAD.pack(
        _MAGIC,
        _digest(description.hash.encode()),
        snapshot.mode,
        snapshot.dirty,
        snapshot.pending,
        snapshot.broken,
        snapshot.anchored,
        snapshot.samples,
        snapshot.origin,
        snapshot.time,
        len(snapshot.buffer),
        len(text),
    )
    content = head + snapshot.buffer + text
    return content + _digest(content)


def from_bytes(data: bytes, description: Description) -> Snapshot | Refused:
    """The snapshot, or why the bytes are refused: foreign, of another version of this FMU, or damaged."""
    if len(data) < _HEAD.size + _DIGEST or data[: len(_MAGIC)] != _MAGIC:
        return Refused("the bytes are not a serialised state of this kind of FMU")
    content, digest = data[:-_DIGEST], data[-_DIGEST:]
    _, owner, mode, dirty, pending, broken, anchored, samples, origin, time, size, length = _HEAD.unpack_from(data)
    if owner != _digest(description.hash.encode()):
        return Refused("the bytes are a state of another FMU or of another version of this FMU")
    if digest != _digest(content) or size != 8 * description.size or len(content) != _HEAD.size + size + length:
        return Refused("the bytes have been damaged or changed")
    buffer = content[_HEAD.size : _HEAD.size + size]
    if (
        not all(map(isfinite, array("d", buffer)))
        or not (isfinite(origin) and isfinite(time))
        or samples < 0
        or mode > 3
    ):
        return Refused("the bytes hold numbers that are not finite")
    strings = tuple((int(slot), str(value)) for slot, value in json.loads(content[_HEAD.size + size :]))
    return Snapshot(buffer, strings, mode, dirty, pending, broken, anchored, samples, origin, time)


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=_DIGEST).digest()
