"""Unpacking archives from strangers: no path leaves the folder, no link, no bomb, no external XML entity."""

from __future__ import annotations

import shutil
import stat
import zipfile
from pathlib import Path, PurePosixPath

from cosim.errors import CosimError

MAX_ENTRIES = 20_000
MAX_BYTES = 1 << 30
_BLOCK = 1 << 20


def unpack(archive: Path, folder: Path) -> None:
    """Unpack the zip file `archive` into the empty or new `folder`; raises CosimError on anything suspicious."""
    if not archive.is_file():
        raise CosimError(f"there is no file {archive}")
    try:
        with zipfile.ZipFile(archive) as zipped:
            _check(archive, zipped.infolist())
            _extract(archive, zipped, folder)
    except CosimError:
        raise
    except Exception as error:  # zipfile raises many kinds: BadZipFile, zlib.error, RuntimeError, EOFError, ...
        raise CosimError(f"{archive} is not a readable zip archive: {error}") from None


def refuse_entities(xml: Path) -> None:
    """Refuse XML that declares entities or a document type, which could read other files or blow up."""
    text = xml.read_bytes()
    if b"\0" in text or text[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise CosimError(f"{xml.name} is not in an 8-bit encoding such as UTF-8")
    if b"<!DOCTYPE" in text or b"<!ENTITY" in text:
        raise CosimError(f"{xml.name} declares a document type or entities, which is refused")


def _check(archive: Path, entries: list[zipfile.ZipInfo]) -> None:
    if len(entries) > MAX_ENTRIES:
        raise CosimError(f"{archive} has {len(entries)} entries; at most {MAX_ENTRIES} are accepted")
    if sum(entry.file_size for entry in entries) > MAX_BYTES:
        raise CosimError(f"{archive} unpacks to more than {MAX_BYTES >> 20} MiB")
    for entry in entries:
        path = PurePosixPath(entry.filename)
        if path.is_absolute() or ".." in path.parts or "\\" in entry.filename or ":" in entry.filename:
            raise CosimError(f"{archive} has the entry {entry.filename!r}, which leads out of the archive")
        if stat.S_ISLNK(entry.external_attr >> 16):
            raise CosimError(f"{archive} has the symbolic link {entry.filename!r}, which is refused")


def _extract(archive: Path, zipped: zipfile.ZipFile, folder: Path) -> None:
    left = MAX_BYTES  # the declared sizes may lie, so the bytes are counted as they come
    for entry in zipped.infolist():
        target = folder / entry.filename
        if entry.is_dir():
            target.mkdir(parents=True, exist_ok=True)
            continue
        target.parent.mkdir(parents=True, exist_ok=True)
        left -= entry.file_size
        if left < 0:
            raise CosimError(f"{archive} unpacks to more than {MAX_BYTES >> 20} MiB")
        with zipped.open(entry) as source, target.open("wb") as sink:
            shutil.copyfileobj(source, sink, _BLOCK)
