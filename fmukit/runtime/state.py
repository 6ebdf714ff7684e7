"""The complete state of an instance, and its form as bytes. No pickle: bytes from a stranger must not run code.

The bytes are: a magic word, a digest of the FMU's hash, the fields of `Life`, the lengths of what follows, the buffer,
the texts as JSON, and a digest of all that.
"""

from __future__ import annotations

import json
import struct
from array import array
from dataclasses import dataclass
from hashlib import blake2b
from math import isfinite

from .description import Description
from .life import MODES, Life

_MAGIC = b"FMUKIT\x00\x01"
_LIFE = {
    "mode": "B",
    "dirty": "?",
    "pending": "?",
    "broken": "?",
    "anchored": "?",
    "samples": "q",
    "origin": "d",
    "time": "d",
}
"""The fields of a life in the order of the bytes, with their types in the language of `struct`."""
_HEAD = struct.Struct(f"<8s16s{''.join(_LIFE.values())}QQ")
_DIGEST = 16


@dataclass(frozen=True, slots=True)
class Snapshot:
    """A copy of all an instance is: the doubles of its buffer, its texts by slot, and its life.

    Not a tuple: PythonFMU would unpack it into several arguments.
    """

    buffer: bytes
    strings: tuple[tuple[int, str], ...]
    life: Life


@dataclass(frozen=True, slots=True)
class Refused:
    """What deserialising gives instead of a snapshot when the bytes are not sound."""

    reason: str


def to_bytes(snapshot: Snapshot, description: Description) -> bytes:
    """The snapshot with the hash of its FMU's package, which alone can read it back."""
    text = json.dumps(snapshot.strings).encode("utf-8")
    owner = _digest(description.hash.encode())
    life = (getattr(snapshot.life, name) for name in _LIFE)
    content = _HEAD.pack(_MAGIC, owner, *life, len(snapshot.buffer), len(text)) + snapshot.buffer + text
    return content + _digest(content)


def from_bytes(data: bytes, description: Description) -> Snapshot | Refused:
    """The snapshot, or why the bytes are refused: foreign, of another version of this FMU, or damaged."""
    if len(data) < _HEAD.size + _DIGEST or data[: len(_MAGIC)] != _MAGIC:
        return Refused("the bytes are not a serialised state of this kind of FMU")
    content, digest = data[:-_DIGEST], data[-_DIGEST:]
    _, owner, *fields, size, length = _HEAD.unpack_from(data)
    if owner != _digest(description.hash.encode()):
        return Refused("the bytes are a state of another FMU or of another version of this FMU")
    if digest != _digest(content) or size != 8 * description.size or len(content) != _HEAD.size + size + length:
        return Refused("the bytes have been damaged or changed")
    buffer, life = content[_HEAD.size : _HEAD.size + size], Life(**dict(zip(_LIFE, fields, strict=True)))
    if not _sound(buffer, life):
        return Refused("the bytes hold numbers that are not finite")
    for scalar, value in zip(description.scalars, array("d", buffer), strict=False):
        if scalar.causality != "output" and scalar.type != "String" and not scalar.low <= value <= scalar.high:
            return Refused(
                f"the bytes hold {scalar.name} = {value!r}, which is outside [{scalar.low:g}, {scalar.high:g}]"
            )
    strings = tuple((int(slot), str(value)) for slot, value in json.loads(content[_HEAD.size + size :]))
    return Snapshot(buffer, strings, life)


def _sound(buffer: bytes, life: Life) -> bool:
    numbers = (*array("d", buffer), life.origin, life.time)
    return all(map(isfinite, numbers)) and life.samples >= 0 and life.mode < len(MODES)


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=_DIGEST).digest()
