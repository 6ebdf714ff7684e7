"""What a Windows library says of itself: machine, format, exports, libraries needed (PE/COFF specification)."""

from __future__ import annotations

import struct
from dataclasses import dataclass

AMD64, PE32_PLUS, DLL = 0x8664, 0x20B, 0x2000


@dataclass(frozen=True)
class Library:
    machine: int
    magic: int
    characteristics: int
    timestamp: int
    exports: tuple[str, ...]
    imports: tuple[str, ...]


class _Image:
    def __init__(self, data: bytes) -> None:
        if data[:2] != b"MZ":
            raise ValueError("no DOS header")
        self.data = data
        self.header = self.number("I", 0x3C)
        if data[self.header : self.header + 4] != b"PE\0\0":
            raise ValueError("no PE header")
        self.optional = self.header + 24

    def number(self, code: str, offset: int) -> int:
        return int(struct.unpack_from("<" + code, self.data, offset)[0])

    def place(self, address: int) -> int:
        """Offset in the file of an address relative to the image base."""
        table = self.optional + self.number("H", self.header + 20)
        for i in range(self.number("H", self.header + 6)):
            size, start, raw, offset = struct.unpack_from("<4I", self.data, table + 40 * i + 8)
            if start <= address < start + max(size, raw):
                return address - start + offset
        raise ValueError(f"address {address:#x} is in no section")

    def text(self, address: int) -> str:
        offset = self.place(address)
        return self.data[offset : self.data.index(b"\0", offset)].decode("ascii")

    def directory(self, index: int) -> int:
        """Offset of a data directory (PE32+: they begin at 112)."""
        return self.place(self.number("I", self.optional + 112 + 8 * index))


def read(data: bytes) -> Library:
    image = _Image(data)
    return Library(
        machine=image.number("H", image.header + 4),
        magic=image.number("H", image.optional),
        characteristics=image.number("H", image.header + 22),
        timestamp=image.number("I", image.header + 8),
        exports=_exports(image),
        imports=_imports(image),
    )


def _exports(image: _Image) -> tuple[str, ...]:
    start = image.directory(0)
    names = image.place(image.number("I", start + 32))
    count = image.number("I", start + 24)
    return tuple(image.text(image.number("I", names + 4 * i)) for i in range(count))


def _imports(image: _Image) -> tuple[str, ...]:
    found, entry = [], image.directory(1)
    while address := image.number("I", entry + 12):
        found.append(image.text(address))
        entry += 20
    return tuple(found)
