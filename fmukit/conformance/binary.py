"""What a shared library is made for, from its first bytes (ELF, PE and Mach-O headers)."""

from __future__ import annotations

import struct

_PE_MACHINE = {0x14C: "win32", 0x8664: "win64"}
_ELF_CLASS = {1: "linux32", 2: "linux64"}
_MACH_O = {b"\xcf\xfa\xed\xfe", b"\xca\xfe\xba\xbe", b"\xca\xfe\xba\xbf"}  # 64 bit, universal, universal of 64 bit


def is_library(head: bytes, platform: str) -> bool:
    """Whether `head`, the first bytes of a file, starts a library for `platform` ("linux64", ...)."""
    if head.startswith(b"\x7fELF"):
        return len(head) > 4 and _ELF_CLASS.get(head[4]) == platform
    if head.startswith(b"MZ"):
        return _PE_MACHINE.get(_machine(head), "") == platform
    return head[:4] in _MACH_O and platform == "darwin64"


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
