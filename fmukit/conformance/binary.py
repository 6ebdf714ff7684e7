"""What a shared library is made for, from its first bytes (ELF, PE and Mach-O headers)."""

from __future__ import annotations

import struct
from dataclasses import dataclass

USUAL = {"win32": "x86", "win64": "x86_64", "linux32": "x86", "linux64": "x86_64"}
"""The processors that the names of platforms stand for; darwin64 is either of two."""
_PE = {0x14C: ("win32", "x86"), 0x8664: ("win64", "x86_64"), 0x1C4: ("win32", "arm"), 0xAA64: ("win64", "aarch64")}
_ELF_CLASS = {1: "linux32", 2: "linux64"}
_ELF_ORDER = {1: "<", 2: ">"}
_ELF = {3: "x86", 62: "x86_64", 40: "arm", 183: "aarch64", 8: "mips", 20: "powerpc", 21: "powerpc64", 243: "riscv"}
_MACH_O = {0x1000007: "x86_64", 0x100000C: "aarch64"}
_UNIVERSAL = {b"\xca\xfe\xba\xbe", b"\xca\xfe\xba\xbf"}  # of 32 and of 64 bit offsets


@dataclass(frozen=True, slots=True)
class Library:
    """The `platform` whose loader takes it ("linux64", ...; "" if it is no library) and the `processor` it is for."""

    platform: str = ""
    processor: str = ""


def library(head: bytes) -> Library:
    """What `head`, the first bytes of a file, says it is."""
    if head.startswith(b"\x7fELF"):
        return _elf(head)
    if head.startswith(b"MZ"):
        return Library(*_PE.get(_machine(head), ("", "")))
    if head[:4] == b"\xcf\xfa\xed\xfe" and len(head) >= 8:
        return Library("darwin64", _MACH_O.get(struct.unpack_from("<I", head, 4)[0], "another processor"))
    return Library("darwin64", "") if head[:4] in _UNIVERSAL else Library()


def _elf(head: bytes) -> Library:
    if len(head) < 20 or head[4] not in _ELF_CLASS or head[5] not in _ELF_ORDER:
        return Library()
    (machine,) = struct.unpack_from(f"{_ELF_ORDER[head[5]]}H", head, 18)
    return Library(_ELF_CLASS[head[4]], _ELF.get(machine, f"processor {machine}"))


def _machine(head: bytes) -> int:
    """The field Machine of the PE header, whose place the DOS header gives at 0x3C."""
    if len(head) < 0x40:
        return 0
    (start,) = struct.unpack_from("<I", head, 0x3C)
    if len(head) < start + 6 or head[start : start + 4] != b"PE\0\0":
        return 0
    (machine,) = struct.unpack_from("<H", head, start + 4)
    return int(machine)


def missing(head: bytes, size: int) -> int:
    """How many bytes a library of `size` bytes lacks of what its header says it has; 0 where the header does not tell.

    The system maps a library without looking whether it is all there: touching what is missing ends the process.
    """
    try:
        ends = _elf_ends(head) if head.startswith(b"\x7fELF\x02\x01") else _pe_ends(head)
    except struct.error:  # the header itself is cut off, or larger than what is looked at
        return max(0, len(head) + 1 - size)
    return max(0, max(ends, default=0) - size)


def _elf_ends(head: bytes) -> list[int]:
    """Where the segments and the table of sections of a 64-bit little-endian ELF file end."""
    segments, sections = struct.unpack_from("<QQ", head, 0x20)
    size, count, section_size, section_count = struct.unpack_from("<HHHH", head, 0x36)
    ends = [sections + section_size * section_count] if section_count else []
    for k in range(count):
        offset, _, _, length = struct.unpack_from("<QQQQ", head, segments + k * size + 8)
        ends.append(offset + length)
    return ends


def _pe_ends(head: bytes) -> list[int]:
    """Where the sections of a PE file end; none for other files."""
    if not head.startswith(b"MZ"):
        return []
    (start,) = struct.unpack_from("<I", head, 0x3C)
    if head[start : start + 4] != b"PE\0\0":
        return []
    (count,) = struct.unpack_from("<H", head, start + 6)
    (optional,) = struct.unpack_from("<H", head, start + 20)
    first = start + 24 + optional
    pairs = [struct.unpack_from("<II", head, first + 40 * k + 16) for k in range(count)]
    return [offset + length for length, offset in pairs]
