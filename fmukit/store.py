"""What was made before and is made again only when what it is made of has changed: FMUs, libraries, plans."""

from __future__ import annotations

import os
import stat
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from hashlib import blake2b
from pathlib import Path
from shutil import rmtree
from time import time

from platformdirs import user_cache_path

from fmukit import files
from fmukit.errors import BuildError

_KEEP = 30 * 24 * 3600.0


def cache_folder() -> Path:
    """Where all that is made for later runs is kept; may be deleted at any time."""
    return user_cache_path("vehicle-formation-fmus")


def kept(folder: str, name: str, make: Callable[[], bytes], root: Path | None = None) -> Path:
    """The file `name` in `folder` of the cache (or of `root`): the bytes of `make()`, made if it is missing or damaged.

    `folder` is "WHAT-KEY", with all in the key that the bytes depend on. A checksum beside the file tells whether it is
    whole: loading half a library ends the process. Folders of the same WHAT not used for a month are removed. Raises
    BuildError when the folder cannot be written, before the long `make()` where that can be known, and when others may
    write it.
    """
    path = (root or cache_folder()) / folder / name
    if _usable(path):
        return path
    check_writable(path.parent)
    data = make()
    try:
        files.write(_sum(path), _digest(data))
        files.write(path, data)
    except OSError as error:
        raise _unwritable(path.parent, error) from error
    prune(path.parent)
    return path


def found(pattern: str, name: str, root: Path | None = None) -> Path | None:
    """The file `name` in whichever folder of the cache fits the pattern and has it whole, the one used last."""
    folders = [(each.stat().st_mtime, each) for each in (root or cache_folder()).glob(pattern) if each.is_dir()]
    return next((each / name for _, each in sorted(folders, reverse=True) if _usable(each / name)), None)


def _usable(path: Path) -> bool:
    """Whether the file is there and whole; raises BuildError when it is not ours alone."""
    _mark_used(path.parent)
    for each in (path.parent.parent, path.parent, path, _sum(path)):
        refuse_shared(each)
    return _whole(path)


def refuse_shared(path: Path) -> None:
    """Raise BuildError for a file or folder that another user may change: what is in it would run with our rights.

    The superuser and the user's own group may. Windows has rights of another kind, which are not looked at.
    """
    if sys.platform == "win32":
        return
    with suppress(OSError):
        status = path.stat()
        foreign = status.st_uid not in (0, os.geteuid())
        shared = status.st_mode & (stat.S_IWOTH | (stat.S_IWGRP if status.st_gid != os.getegid() else 0))
        if foreign or shared:
            why = (
                "belongs to another user" if foreign else f"may be written by others (mode {status.st_mode & 0o777:o})"
            )
            raise BuildError(
                f"{path} {why}, so it is not used: it would run with your rights; "
                "remove it, or name another place in XDG_CACHE_HOME"
            )


def _whole(path: Path) -> bool:
    """Whether the file is there and holds what was made: a full disk or a cut connection may have left half of it."""
    try:
        return _sum(path).read_bytes() == _digest(path.read_bytes())
    except OSError:
        return False


def _sum(path: Path) -> Path:
    return path.with_name(f"{path.name}.sum")


def _digest(data: bytes) -> bytes:
    return blake2b(data, digest_size=16).hexdigest().encode()


def _mark_used(folder: Path) -> None:
    """So that it is not pruned, not even while it is being read; what cannot be written is not pruned either."""
    with suppress(OSError):
        os.utime(folder)


def check_writable(folder: Path) -> None:
    """Say so before the long build."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=folder) as file:
            file.write(b"x")
    except OSError as error:
        raise _unwritable(folder, error) from error


def _unwritable(folder: Path, error: OSError) -> BuildError:
    return BuildError(
        f"the cache folder {folder} cannot be written ({error.strerror}); "
        "make it writable, free some space, or name another place in XDG_CACHE_HOME"
    )


def prune(made: Path) -> None:
    """Remove the folders beside `made` of the same name but for the key that were not used for a month.

    Never fails: another process may prune too, and what cannot be removed may stay.
    """
    with suppress(OSError):
        for other in list(made.parent.glob(made.name.rpartition("-")[0] + "-*")):
            with suppress(OSError):
                if time() - other.stat().st_mtime > _KEEP:
                    rmtree(other, ignore_errors=True)
