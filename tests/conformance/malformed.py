"""Files that pretend to be FMUs: `MALFORMED` says by name how to write one from a good FMU."""

from __future__ import annotations

import struct
import zipfile
from collections.abc import Callable
from pathlib import Path

from broken import BROKEN, XML

Make = Callable[[Path, Path], object]


def _bytes(change: Callable[[bytes], bytes]) -> Make:
    return lambda good, target: target.write_bytes(change(good.read_bytes()))


def _document(change: Callable[[bytes], bytes]) -> Make:
    """The good FMU with another description."""

    def make(good: Path, target: Path) -> None:
        with zipfile.ZipFile(good) as source, zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as sink:
            for name in source.namelist():
                data = source.read(name)
                sink.writestr(name, change(data) if name == XML else data)

    return make


def _lies_about_its_size(data: bytes) -> bytes:
    """The first entry claims, in both headers, to unpack to 1 byte."""
    one = struct.pack("<I", 1)
    place = data.index(b"PK\x01\x02") + 24
    return data[:22] + one + data[26:place] + one + data[place + 4 :]


def _laughs(xml: bytes) -> bytes:
    """Ten levels of ten: a gigabyte of laughter."""
    levels = "".join(f'<!ENTITY l{i} "{f"&l{i - 1};" * 10}">' for i in range(1, 10))
    text = f'?><!DOCTYPE f [<!ENTITY l0 "{"ha" * 5}">{levels}]>'
    return xml.replace(b"?>", text.encode(), 1).replace(b'modelName="Imu"', b'modelName="&l9;"')


def _encrypted(data: bytes) -> bytes:
    """The flag of encryption on the first entry, in both headers."""
    place = data.index(b"PK\x01\x02") + 8
    return data[:6] + b"\x01" + data[7:place] + b"\x01" + data[place + 1 :]


def _unlimited(method: int) -> Make:
    """A description that claims 10 bytes and unpacks to 256 MiB by a method zipfile puts no limit to."""

    def make(good: Path, target: Path) -> None:
        with zipfile.ZipFile(target, "w", method) as sink:
            sink.writestr(XML, bytes(256 << 20))
        data = target.read_bytes()
        place = data.rindex(b"PK\x01\x02") + 24
        target.write_bytes(
            data[:22] + struct.pack("<I", 10) + data[26:place] + struct.pack("<I", 10) + data[place + 4 :]
        )

    return make


_EXTERNAL = b'?><!DOCTYPE f [<!ENTITY x SYSTEM "file:///etc/passwd">]>'
_REMOTE = b'?><!DOCTYPE f SYSTEM "http://127.0.0.1:9/f.dtd">'

MALFORMED: dict[str, Make] = {
    "empty file": _bytes(lambda data: b""),
    "not a zip": _bytes(lambda data: b"modelDescription" * 100),
    "cut in the middle": _bytes(lambda data: data[: len(data) // 2]),
    "cut at the end": _bytes(lambda data: data[:-30]),
    "lost its beginning": _bytes(lambda data: data[5000:]),
    "zeros in the middle": _bytes(lambda data: data[:1000] + bytes(8000) + data[9000:]),
    "size that lies": _bytes(_lies_about_its_size),
    "bzip2 bomb": _unlimited(zipfile.ZIP_BZIP2),
    "LZMA bomb": _unlimited(zipfile.ZIP_LZMA),
    "encrypted": _bytes(_encrypted),
    "empty archive": _bytes(lambda data: b"PK\x05\x06" + bytes(18)),
    "external entity": _document(lambda xml: xml.replace(b"?>", _EXTERNAL, 1).replace(b"Imu", b"&x;", 1)),
    "remote document type": _document(lambda xml: xml.replace(b"?>", _REMOTE, 1)),
    "billion laughs": _document(_laughs),
    "UTF-16": _document(lambda xml: xml.decode().replace("UTF-8", "UTF-16").encode("utf-16")),
    "UTF-7": _document(lambda xml: xml.decode().replace("UTF-8", "UTF-7").encode("utf-7")),
    "not UTF-8": _document(lambda xml: xml.replace(b'modelName="Imu"', b'modelName="\xff\xfe"')),
    "empty document": _document(lambda xml: b""),
    "no XML": _document(lambda xml: b"\x00\x01\x02" * 100),
    "another document": _document(lambda xml: b"<html><body/></html>"),
    "deep document": _document(lambda xml: b"<a>" * 100_000),
}
ESCAPE = _document(lambda xml: xml.replace(b'name="fault"', 'name="\x9b31m"'.encode()))
MALFORMED |= {
    f"{broken.rule} {broken.says}": broken.make for broken in BROKEN if broken.rule in ("A3", "A4", "A5", "A6", "A7")
}
