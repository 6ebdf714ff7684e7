"""Archives that lie, by name: how to write each from the entries of a good FMU. Something is wrong with all of them."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

from raw_zip import Entry, archive

XML = "modelDescription.xml"
Make = Callable[[Path, Path], object]


def members(good: Path) -> list[Entry]:
    """The entries of the good FMU that matter, its description first."""
    with zipfile.ZipFile(good) as source:
        names = sorted(source.namelist(), key=lambda name: (name != XML, name))
        return [Entry(name.encode(), source.read(name)) for name in names if not name.startswith("documentation/")]


def beside(*entries: Entry, **lies: int) -> Make:
    """The good entries and these."""
    return lambda good, target: target.write_bytes(archive([*members(good), *entries], **lies))


def instead(change: Callable[[Entry], Entry]) -> Make:
    """The good entries with another description."""

    def make(good: Path, target: Path) -> None:
        first, *rest = members(good)
        target.write_bytes(archive([change(first), *rest]))

    return make


def altered(change: Callable[[bytes], bytes]) -> Make:
    """The bytes of the good archive, changed."""
    return lambda good, target: target.write_bytes(change(archive(members(good))))


def _told(**lies: object) -> Callable[[Entry], Entry]:
    return lambda entry: Entry(entry.name, entry.data, central=lies)


def _zip64(packed: int, size: int, offset: int) -> bytes:
    return struct.pack("<HHQQQ", 1, 24, size, packed, offset)


SLIPS = (
    "../slip", "../../../../../../tmp/slip", "..\\slip", "/slip", "//slip", "\\slip", "C:/slip", "C:\\slip", "c:slip",
    "\\\\server\\share\\slip", "resources/../../slip", "resources/./../../slip", "./../slip", "resources/..", "..",
    "file:///slip", "resources/slip:stream", "resources\\..\\..\\slip", "binaries/../../slip", "~/slip",
)  # fmt: skip
RESERVED = ("CON", "nul.txt", "aux.c", "COM1", "lpt9.log", "end.", "end ", "a<b", "a|b", 'a"b', "a*b", "a\x07b")
KINDS = {"link": 0o120777, "pipe": 0o010644, "device": 0o020644, "disk": 0o060644, "socket": 0o140644}
TWINS = ("resources/slavemodule.txt", "resources/SLAVEMODULE.TXT", "resources//slavemodule.txt", XML, XML.upper(),
         "./resources/slavemodule.txt")  # fmt: skip
ARCHIVES: dict[str, Make] = {f"slip {name}": beside(Entry(name.encode(), b"slipped")) for name in SLIPS}
ARCHIVES |= {f"name {name!r}": beside(Entry(f"resources/{name}".encode(), b"x")) for name in RESERVED}
ARCHIVES |= {f"a {kind}": beside(Entry(b"resources/odd", b"/etc/passwd", mode=mode)) for kind, mode in KINDS.items()}
ARCHIVES |= {f"twice {name}": beside(Entry(name.encode(), b"other")) for name in TWINS}
ARCHIVES |= {f"method {method}": beside(Entry(b"resources/odd", b"x" * 99, method)) for method in (1, 6, 9, 12, 14, 99)}
_ZEROS = bytes(20 << 20)
ARCHIVES |= {
    "a bomb": beside(Entry(b"resources/zeros", bytes(64 << 20))),
    "many small bombs": beside(*(Entry(f"resources/{k}".encode(), bytes(4 << 20)) for k in range(20))),
    "one bomb under many names": beside(
        Entry(b"resources/zeros", _ZEROS),
        *(Entry(b"x%d" % k, b"", central={"size": 20 << 20, "packed": 20380, "offset": 0}) for k in range(99)),
    ),
    "too many entries": beside(*(Entry(b"resources/%d" % k, b"") for k in range(20_001))),
    "a terabyte is told of": beside(
        Entry(
            b"resources/odd", b"x", central={"size": 2**32 - 1, "packed": 2**32 - 1, "extra": _zip64(2**40, 2**40, 0)}
        )
    ),
    "4 GiB are told of": beside(Entry(b"resources/odd", b"x", central={"size": 2**32 - 2})),
    "less is told than there is": instead(_told(size=10)),
    "nothing is told of": instead(_told(size=0)),
    "more is told than there is": instead(_told(size=10_000_000)),
    "a packed size of 1": instead(_told(packed=1)),
    "a packed size beyond the end": instead(_told(packed=2**31)),
    "another checksum": instead(_told(crc=1)),
    "another name in the table": instead(_told(name=b"modelDescription.xm_")),
    "the table leads beyond the end": instead(_told(offset=2**31)),
    "the table leads into the middle": instead(_told(offset=100)),
    "encrypted in the table": instead(_told(flags=1)),
    "patched data": instead(_told(flags=32)),
    "strong encryption": instead(_told(flags=65)),
    "not deflated at all": instead(lambda entry: Entry(entry.name, b"\xff" * 500, 0, central={"method": 8})),
    "no name": instead(lambda entry: Entry(b"", entry.data)),
    "a name with a zero": instead(lambda entry: Entry(b"modelDescription.xml\0.exe/../x", entry.data)),
    "a name that is no UTF-8": instead(lambda entry: Entry(b"\xff\xfe.xml", entry.data, flags=0x800)),
    "a name of 60 000 letters": instead(lambda entry: Entry(b"m" * 60_000, entry.data)),
    "a name of 5 000 folders": beside(Entry(b"d/" * 5_000 + b"x", b"x")),
    "the description is a folder": instead(lambda entry: Entry(entry.name + b"/", entry.data)),
    "the description is in a folder": instead(lambda entry: Entry(b"fmu/" + entry.name, entry.data)),
    "the description is an archive": instead(lambda entry: Entry(entry.name, archive([entry]))),
    "an extra field that is too long": instead(_told(extra=struct.pack("<HH", 1, 60_000) + bytes(10))),
    "zip64 without its fields": instead(_told(size=2**32 - 1, packed=2**32 - 1)),
    "the table starts beyond the end": beside(start=2**31),
    "only an end": lambda good, target: target.write_bytes(archive([])),
    "an end without an archive": lambda good, target: target.write_bytes(archive([], count=7, start=1 << 20)),
    "cut in the table": altered(lambda data: data[:-200]),
    "cut in the end": altered(lambda data: data[:-5]),
    "zeros only": lambda good, target: target.write_bytes(bytes(100_000)),
    "an ELF file": lambda good, target: target.write_bytes(b"\x7fELF\x02\x01\x01" + bytes(5_000)),
    "a gzip file": lambda good, target: target.write_bytes(b"\x1f\x8b\x08" + bytes(5_000)),
    "a binary that is text": beside(Entry(b"binaries/win64/Imu.dll", b"not a library")),
    "a binary of no bytes": beside(Entry(b"binaries/win64/Imu.dll", b"")),
    "a binary of a wild header": beside(Entry(b"binaries/win64/Imu.dll", b"MZ" + b"\xff" * 200)),
}
