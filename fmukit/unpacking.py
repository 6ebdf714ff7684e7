"""Reading archives from strangers: no path leaves the folder, no link, no bomb, no document type in XML."""

from __future__ import annotations

import errno
import re
import stat
import zipfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import IO

MAX_ENTRIES = 20_000
MAX_BYTES = 1 << 30
MAX_XML = 64 << 20
MAX_RATIO = 200  # of entries larger than _SMALL: text and code stay below 20, files of zeros reach 1000
_SMALL, _MIDDLING = 16 << 20, 64 << 20
_METHODS = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)  # the others are unpacked without a limit on their output
_BLOCK = 1 << 20
_RESERVED = re.compile(r"(con|prn|aux|nul|conin\$|conout\$|(com|lpt)[1-9¹²³]) *(\..*)?", re.IGNORECASE | re.DOTALL)
_FORBIDDEN = re.compile(r'[<>"|?*\x00-\x1f]')
_ENCODING = re.compile(rb"""^\s*<\?xml[^>]*?encoding\s*=\s*["']([^"']*)["']""")


class ArchiveError(Exception):
    """An archive that cannot or must not be read; the text is one sentence."""


def entries_of(archive: Path) -> list[zipfile.ZipInfo]:
    """The table of contents of the zip file `archive`; raises ArchiveError if it has none."""
    with _opened(archive) as zipped:
        return zipped.infolist()


def read_member(archive: Path, name: str, most: int = MAX_XML) -> bytes:
    """The bytes of one entry, refused if more than `most`."""
    try:
        with _opened(archive) as zipped:
            for sentence in packed_otherwise([zipped.getinfo(name)]):
                raise ArchiveError(f"{archive} has {sentence}")
            with zipped.open(name) as source:
                data = source.read(most + 1)
    except ArchiveError:
        raise
    except Exception as error:
        raise _unreadable(archive, error) from None
    if len(data) > most:
        raise ArchiveError(f"{archive} has the entry {name} of more than {most >> 20} MiB")
    return data


def unpack(archive: Path, folder: Path) -> None:
    """Unpack the zip file `archive` into the empty or new `folder`; raises ArchiveError on anything suspicious."""
    with _opened(archive) as zipped:
        for sentence in hazards(zipped.infolist()):
            raise ArchiveError(f"{archive} {sentence}")
        try:
            _extract(archive, zipped, folder)
        except ArchiveError:
            raise
        except Exception as error:  # zipfile raises many kinds: BadZipFile, zlib.error, RuntimeError, EOFError, ...
            raise _unreadable(archive, error) from None


def hazards(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """What makes an archive unsafe to unpack: sentences without a subject, which is the archive."""
    yield from oversize(entries)
    yield from (f"has {sentence}" for sentence in packed_otherwise(entries))
    for entry in entries:
        if "\\" in entry.filename:
            yield f"has the entry {entry.filename!r} with a backslash; folders in a zip file end with /; pack it again"
        elif escapes(entry.filename):
            yield f"has the entry {entry.filename!r}, which leads out of the archive"
        elif hides(entry):
            yield f"has the entry {entry.orig_filename!r} with a zero in its name"
        if is_special(entry):
            yield f"has {entry.filename!r}, which is a symbolic link or device and is refused"
    yield from duplicates(entries)


def oversize(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Too many entries, too many bytes or a compression no honest file reaches."""
    if len(entries) > MAX_ENTRIES:
        yield f"has {len(entries)} entries; at most {MAX_ENTRIES} are accepted"
    unpacked, packed = (sum(getattr(entry, size) for entry in entries) for size in ("file_size", "compress_size"))
    if unpacked > MAX_BYTES:
        yield f"unpacks to more than {MAX_BYTES >> 20} MiB"
    elif unpacked > _MIDDLING and unpacked > MAX_RATIO * packed:
        yield f"has {unpacked} bytes packed into {packed}"
    for entry in entries:
        if entry.file_size > _SMALL and entry.file_size > MAX_RATIO * entry.compress_size:
            yield f"has {entry.filename!r}, which is {entry.file_size} bytes packed into {entry.compress_size}"


def packed_otherwise(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Entries neither stored nor deflated."""
    for entry in entries:
        if entry.compress_type not in _METHODS:
            yield f"{entry.filename!r}, which is packed with method {entry.compress_type}, not stored or deflated"


def escapes(name: str) -> bool:
    """Whether unpacking the entry could write outside the folder, on any system."""
    path = PurePosixPath(name)
    return path.is_absolute() or ".." in path.parts or "\\" in name or ":" in name


def hides(entry: zipfile.ZipInfo) -> bool:
    """Whether the name holds a zero, at which some readers let it end and others do not."""
    return "\0" in entry.orig_filename


def damaged(archive: Path) -> Iterator[str]:
    """What is wrong with the entries themselves, all of which are read: sentences on single entries."""
    length = archive.stat().st_size
    with _opened(archive) as zipped:
        for entry in zipped.infolist():
            if entry.header_offset + entry.compress_size > length:
                yield f"the entry {entry.filename!r} lies beyond the end of the file"
                continue
            try:
                with zipped.open(entry) as source:
                    size = sum(map(len, iter(lambda: source.read(_BLOCK), b"")))
            except zipfile.BadZipFile as error:
                lost = "CRC-32" in str(error)
                yield f"the entry {entry.filename!r} " + (
                    "does not match its checksum" if lost else f"cannot be read: {' '.join(str(error).split())}"
                )
                continue
            if size != entry.file_size:
                yield f"the entry {entry.filename!r} is said to have {entry.file_size} bytes and has {size}"


def reserved(name: str) -> bool:
    """Whether Windows cannot have a file of that name, or gives it another one."""
    return any(_RESERVED.fullmatch(part) or part[-1] in ". " or _FORBIDDEN.search(part) for part in _parts(name))


def _parts(name: str) -> Iterator[str]:
    yield from (part for part in name.split("/") if part not in ("", ".", ".."))


def is_special(entry: zipfile.ZipInfo) -> bool:
    """Whether the entry is neither a file nor a folder: a symbolic link, a pipe, a device."""
    return stat.S_IFMT(entry.external_attr >> 16) not in (0, stat.S_IFREG, stat.S_IFDIR)


def duplicates(entries: Sequence[zipfile.ZipInfo]) -> Iterator[str]:
    """Names that lead to the same file twice, also if only on systems that do not tell `A` from `a`."""
    for name, count in Counter(PurePosixPath(entry.filename).as_posix().casefold() for entry in entries).items():
        if count > 1:
            yield f"has {count} entries of the name {name!r}"


def refuse_entities(name: str, data: bytes) -> None:
    """Refuse XML that declares entities or a document type, which could read other files or blow up."""
    encoding = _ENCODING.match(data.removeprefix(b"\xef\xbb\xbf"))
    plain = encoding is None or re.fullmatch(rb"utf-8|us-ascii|ascii|(iso-8859|windows)-\d+", encoding[1].lower())
    if not plain or b"\0" in data or data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise ArchiveError(f"{name} is not in an 8-bit encoding such as UTF-8")
    if b"<!DOCTYPE" in data or b"<!ENTITY" in data:
        raise ArchiveError(f"{name} declares a document type or entities, which is refused")


def _opened(archive: Path) -> zipfile.ZipFile:
    if not archive.is_file():
        raise ArchiveError(f"there is no file {archive}")
    try:
        return zipfile.ZipFile(archive)
    except Exception as error:
        raise _unreadable(archive, error) from None


def _unreadable(archive: Path, error: Exception) -> ArchiveError:
    return ArchiveError(f"{archive} is not a readable zip archive: {' '.join(str(error).split())}")


def _extract(archive: Path, zipped: zipfile.ZipFile, folder: Path) -> None:
    for entry in zipped.infolist():  # zipfile hands out no more bytes than an entry declares
        target = folder / entry.filename
        if entry.is_dir():
            with _writing(archive, folder):
                target.mkdir(parents=True, exist_ok=True)
            continue
        with zipped.open(entry) as source, _writing(archive, folder):
            target.parent.mkdir(parents=True, exist_ok=True)
            with target.open("wb") as sink:
                for block in _blocks(source):
                    sink.write(block)


def _blocks(source: IO[bytes]) -> Iterator[bytes]:
    try:
        while block := source.read(_BLOCK):
            yield block
    except OSError as error:  # a damaged archive can send zipfile to impossible places
        raise zipfile.BadZipFile(str(error)) from None


@contextmanager
def _writing(archive: Path, folder: Path) -> Iterator[None]:
    """What fails in here is the disk, not the archive."""
    try:
        yield
    except OSError as error:
        full = error.errno in (errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EACCES, errno.EROFS, errno.EPERM)
        remedy = "make room there, or set TMPDIR to another folder" if full else "make the FMU again"
        raise ArchiveError(f"cannot unpack {archive} into {folder}: {error.strerror or error}; {remedy}") from None
