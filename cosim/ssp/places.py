"""Where the files of a system are: beside its description, in its archive, or inside one of its FMUs.

A `source` is a URI reference, relative to the file that holds it (RFC 3986; SSP 2.0, 2.3). What an archive refers to
with relative references must be in it.
"""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from urllib.parse import unquote, urlsplit
from urllib.request import url2pathname

from cosim.errors import CosimError
from cosim.ssp.document import Where
from fmukit.errors import because
from fmukit.unpacking import MAX_XML, ArchiveError, read_member, unpack

DEFAULT = "SystemStructure.ssd"


@dataclass(frozen=True, slots=True)
class Folder:
    """The folder `path` of a file that refers to others.

    `top` is that of the archive it was unpacked from, which is called `archive`; None and "" for a folder of the user.
    """

    path: Path
    top: Path | None = None
    archive: str = ""

    def called(self, path: Path) -> str:
        """What the file is called to the user, the same in every run."""
        if self.top is not None and path.is_relative_to(self.top):
            return f"{self.archive}: {path.relative_to(self.top).as_posix()}"
        return str(path)

    def model(self, path: Path) -> str:
        """What the FMU is called, which is its path where it lies in no archive."""
        if self.top is not None and path.is_relative_to(self.top):
            inner = self.archive.partition(": ")[2]
            return "/".join(filter(None, [inner, path.relative_to(self.top).as_posix()]))
        return str(path)

    def holding(self, file: Path) -> Folder:
        """The folder of a file found from here."""
        return Folder(file.parent, self.top, self.archive)


@dataclass(slots=True)
class Archives:
    """Archives unpacked into `root`, once each."""

    root: Path
    unpacked: dict[Path, Path] = field(default_factory=dict)

    def opened(self, archive: Path, called: str) -> Folder:
        """The folder of what the archive contains; raises CosimError for one that cannot or must not be unpacked."""
        if archive not in self.unpacked:
            folder = self.root / str(len(self.unpacked))
            try:
                unpack(archive, folder)
            except ArchiveError as error:
                raise CosimError(str(error)) from None
            self.unpacked[archive] = folder
        return Folder(self.unpacked[archive], self.unpacked[archive], called)


def located(uri: str, folder: Folder, where: Where) -> tuple[Path, str]:
    """The file that the URI reference means, and its fragment; raises CosimError where there is none."""
    split = urlsplit(uri)
    if split.scheme not in ("", "file") or split.netloc not in ("", "localhost"):
        raise CosimError(f"{where}: {uri!r} is not on this machine; fetch it and refer to the file")
    plain = url2pathname(split.path) if split.scheme else unquote(split.path)
    path = Path(os.path.normpath(folder.path / plain))
    if folder.top is not None and not split.scheme and not path.is_relative_to(folder.top):
        raise CosimError(f"{where}: {uri!r} leads out of {folder.archive}; pack the file into it")
    if path.is_file():
        return path, unquote(split.fragment)
    literal = folder.path / uri
    if not split.scheme and ".." not in literal.parts and literal.is_file():  # a name that is not encoded
        return literal, ""
    raise CosimError(f"{where}: {_missing(uri, path, folder)}")


def read_file(path: Path, called: str) -> bytes:
    """What the file holds, if that is not more than XML of ours ever is; raises CosimError."""
    try:
        with path.open("rb") as file:
            data = file.read(MAX_XML + 1)
    except OSError as error:
        raise CosimError(f"{called} cannot be read: {because(error)}") from None
    if len(data) > MAX_XML:
        raise CosimError(f"{called} has more than {MAX_XML >> 20} MiB")
    return data


def read_inside(archive: Path, uri: str, where: Where) -> bytes:
    """The member of an FMU that the URI, relative to its top, means; raises CosimError."""
    try:
        return read_member(archive, os.path.normpath(unquote(urlsplit(uri).path)))
    except ArchiveError as error:
        raise CosimError(f"{where}: {error}") from None


def _missing(uri: str, path: Path, folder: Folder) -> str:
    if "\\" in uri:
        return f"{uri!r} has a backslash; folders in a URI end with /"
    if folder.top is not None:
        return f"{folder.archive} has no file {uri!r}; pack it, or mend the reference"
    hint = " (a # or % in a name is written %23 or %25)" if "#" in uri or "%" in uri else ""
    return f"there is no file {path}; put it there, or mend the reference{hint}"
