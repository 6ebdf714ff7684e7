"""Temporary folders that a killed process leaves behind, and that the next one sweeps.

Whoever made a folder holds a lock in it, which the operating system lets go of when the process ends, however it does.
"""

from __future__ import annotations

import os
import shutil
import stat
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from time import time

from filelock import FileLock, Timeout

LOCK = ".lock"
_YOUNG = 60.0
"""[s] in which a folder may have its lock file but not yet its lock."""


@contextmanager
def scratch(prefix: str, place: Path) -> Iterator[Path]:
    """A new folder in `place` for as long as the block lasts; those of the same prefix whose makers are dead are swept.

    Raises OSError when there can be none.
    """
    sweep(prefix, place)
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=place))
    lock = FileLock(folder / LOCK, timeout=0)
    lock.acquire()
    try:
        yield folder
    finally:
        lock.release()
        shutil.rmtree(folder, ignore_errors=True)


def sweep(prefix: str, place: Path) -> None:
    """Remove the user's folders of that prefix in `place` that nobody holds; never fails."""
    with suppress(OSError):
        for folder in list(place.glob(f"{prefix}*")):
            if _is_own(folder) and _is_left(folder):
                shutil.rmtree(folder, ignore_errors=True)


def _is_own(folder: Path) -> bool:
    """Whether it is a folder, no link to one, that this user made."""
    with suppress(OSError):
        status = folder.lstat()
        return stat.S_ISDIR(status.st_mode) and (not hasattr(os, "geteuid") or status.st_uid == os.geteuid())
    return False


def _is_left(folder: Path) -> bool:
    """Whether its maker has died: its lock can be had."""
    with suppress(OSError, Timeout):
        if time() - (folder / LOCK).stat().st_mtime > _YOUNG:
            with FileLock(folder / LOCK, timeout=0):
                return True
    return False
