"""What was made before and is made again only when what it is made of has changed: FMUs, libraries, plans."""

from __future__ import annotations

import os
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
    BuildError when the folder cannot be written, before the long `make()` where that can be known.
    """
    path = (root or cache_folder()) / folder / name
    _mark_used(path.parent)
    if _whole(path):
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
