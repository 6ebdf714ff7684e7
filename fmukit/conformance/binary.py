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
