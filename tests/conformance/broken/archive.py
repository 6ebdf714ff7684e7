"""Broken archives: group A."""

from __future__ import annotations

import stat
import zipfile
from collections.abc import Iterable, Iterator
from typing import Any

from lxml import etree

from broken.making import XML, Entry, Members, archive, description, renamed


@archive("A1", "does not match its checksum")
def _flipped(members: Members) -> Iterable[Entry]:
    """Stored as it is, so that a test can flip a letter of it."""
    yield from members.items()
    yield zipfile.ZipInfo("resources/flipped.txt"), b"FLIPPED"


for _method in (zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA):

    @archive("A2", f"is packed with method {_method}")
    def _packed(members: Members, method: int = _method) -> Iterator[Entry]:
        yield from members.items()
        item = zipfile.ZipInfo("resources/packed.txt")
        item.compress_type = method
        yield item, b"x" * 100


for _name in ("../escape.txt", "/etc/escape.txt", "C:/escape.txt", "resources\\escape.txt", "resources/../../escape"):

    @archive("A3", repr(_name))
    def _escape(members: Members, name: str = _name) -> Iterator[Entry]:
        yield from members.items()
        yield name, b"x"


@archive("A4", "is a symbolic link or device")
def _link(members: Members) -> Iterator[Entry]:
    yield from members.items()
    item = zipfile.ZipInfo("resources/link")
    item.create_system, item.external_attr = 3, (stat.S_IFLNK | 0o777) << 16
    yield item, b"/etc/passwd"


@archive("A5", "2 entries of the name 'resources/twice.txt'")
def _twice(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield from (("resources/twice.txt", b"1"), ("resources/twice.txt", b"2"))


@archive("A5", "2 entries of the name 'resources/slavemodule.txt'")
def _capitals(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources/SlaveModule.txt", b"other"


@archive("A5", "2 entries of the name 'resources/slavemodule.txt'")
def _slashes(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources//slavemodule.txt", b"other"


@archive("A6", "33554432 bytes packed into")
def _bomb(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield "resources/zeros.bin", bytes(32 << 20)


@archive("A6", "bytes packed into")
def _swarm(members: Members) -> Iterator[Entry]:
    """None of them is large."""
    yield from members.items()
    yield from ((f"resources/zeros{k}.bin", bytes(8 << 20)) for k in range(40))


@archive("A6", "at most 20000 are accepted")
def _crowd(members: Members) -> Iterator[Entry]:
    yield from members.items()
    yield from ((f"resources/{i}", b"") for i in range(20_001))


@archive("A7", "there is no modelDescription.xml, but 'ModelDescription.xml'")
def _misspelt(members: Members) -> Iterable[Entry]:
    return (members | {"ModelDescription.xml": members.pop(XML)}).items()


@archive("A8", "there is binaries/linux_x64")
def _platform(members: Members) -> Iterable[Entry]:
    return renamed(members, "binaries/linux64", "binaries/linux_x64")


@archive("A9", "there is no binaries/linux64/Imu.so; the folder has Sensor.so")
def _library(members: Members) -> Iterable[Entry]:
    return renamed(members, "binaries/linux64/Imu.so", "binaries/linux64/Sensor.so")


@archive("A10", "binaries/win64/Imu.dll is not a win64 library")
def _elf_for_windows(members: Members) -> Iterable[Entry]:
    return (members | {"binaries/win64/Imu.dll": members["binaries/linux64/Imu.so"]}).items()


@archive("A10", "binaries/linux64/Imu.so is empty")
def _empty(members: Members) -> Iterable[Entry]:
    return (members | {"binaries/linux64/Imu.so": b""}).items()


@archive("A10", "binaries/linux64/Imu.so is not a linux64 library")
def _narrow(members: Members) -> Iterable[Entry]:
    """The class of 32 bit."""
    binary = members["binaries/linux64/Imu.so"]
    return (members | {"binaries/linux64/Imu.so": binary[:4] + b"\x01" + binary[5:]}).items()


@archive("A16", "binaries/linux64/Imu.so is made for aarch64")
def _other_processor(members: Members) -> Iterable[Entry]:
    binary = members["binaries/linux64/Imu.so"]
    return (members | {"binaries/linux64/Imu.so": binary[:18] + b"\xb7\x00" + binary[20:]}).items()


for _name in (
    "extra/CON",
    "resources/nul.txt",
    "resources/Com1.tar.gz",
    "resources/end.",
    "resources/a?b",
    "extra/lpt\u00b2",
):

    @archive("A17", f"Windows has no file or folder {_name!r}")
    def _unspeakable(members: Members, name: str = _name) -> Iterator[Entry]:
        yield from members.items()
        yield name, b"x"


@archive("A11", "'notes.txt' at the root")
def _litter(members: Members) -> Iterable[Entry]:
    return (members | {"notes.txt": b"mine"}).items()


@archive("A12", "no index.html")
def _no_index(members: Members) -> Iterable[Entry]:
    return [(name, data) for name, data in members.items() if name != "documentation/index.html"]


@description("A13", "'imu.c', which is not in sources/")
def _sources(root: Any) -> None:
    files = etree.SubElement(root.find("CoSimulation"), "SourceFiles")
    etree.SubElement(files, "File", name="imu.c")


@archive("A14", "names the script 'other'")
def _script(members: Members) -> Iterable[Entry]:
    return (members | {"resources/slavemodule.txt": b"other"}).items()


def _shortened(members: Members, name: str) -> Iterable[Entry]:
    return (members | {name: members[name][: len(members[name]) // 2]}).items()


@archive("A15", "binaries/linux64/Imu.so has")
def _half_a_binary(members: Members) -> Iterable[Entry]:
    return _shortened(members, "binaries/linux64/Imu.so")


@archive("A15", "kernel.so has")
def _half_a_kernel(members: Members) -> Iterable[Entry]:
    return _shortened(members, next(name for name in members if name.endswith("/kernel.so")))


@archive("A15", "binaries/linux64/Imu.so has 60 bytes and lacks 1 of")
def _less_than_a_header(members: Members) -> Iterable[Entry]:
    return (members | {"binaries/linux64/Imu.so": members["binaries/linux64/Imu.so"][:60]}).items()
