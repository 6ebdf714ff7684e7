"""Zip archives written byte by byte, so that every field of every header may lie."""

from __future__ import annotations

import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass, field, replace

_LOCAL, _CENTRAL, _END = b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"


@dataclass(frozen=True)
class Entry:
    """One entry; fields of None are told as they are, `central` has what the table of contents tells instead."""

    name: bytes
    data: bytes
    method: int = 8
    flags: int = 0
    crc: int | None = None
    packed: int | None = None
    size: int | None = None
    extra: bytes = b""
    mode: int = 0o100644
    offset: int | None = None
    central: dict[str, object] = field(default_factory=dict)

    def body(self) -> bytes:
        if self.method != 8:
            return self.data
        packer = zlib.compressobj(9, zlib.DEFLATED, -15)
        return packer.compress(self.data) + packer.flush()

    def common(self) -> bytes:
        """The fields from the version to the lengths, which both headers have."""
        crc = zlib.crc32(self.data) if self.crc is None else self.crc
        packed = len(self.body()) if self.packed is None else self.packed
        size = len(self.data) if self.size is None else self.size
        lengths = (len(self.name), len(self.extra))
        return struct.pack("<HHHHHIIIHH", 20, self.flags, self.method, 0, 0x21, crc, packed, size, *lengths)

    def told(self) -> Entry:
        return replace(self, central={}, **self.central)  # type: ignore[arg-type]


def archive(entries: Sequence[Entry], *, count: int | None = None, start: int | None = None) -> bytes:
    """The archive; `count` and `start` are what its end tells of the number of entries and of their table."""
    blob, table = b"", b""
    for entry in entries:
        place = len(blob)
        blob += _LOCAL + entry.common() + entry.name + entry.extra + entry.body()
        told = entry.told()
        offset = place if told.offset is None else told.offset
        body = told.common()
        lengths, rest = body[-4:], struct.pack("<HHHII", 0, 0, 0, told.mode << 16, offset)
        table += _CENTRAL + struct.pack("<H", 0x0314) + body[:-4] + lengths + rest + told.name + told.extra
    number = len(entries) if count is None else count
    place = len(blob) if start is None else start
    end = struct.pack("<HHHHIIH", 0, 0, number & 0xFFFF, number & 0xFFFF, len(table), place & 0xFFFFFFFF, 0)
    return blob + table + _END + end
