"""A folder of results belongs to one run at a time."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from filelock import FileLock, Timeout

from cosim.errors import CosimError
from fmukit.errors import because

LOCK = ".lock"
"""Held while a run writes; the operating system lets go of it when the process ends, however it does."""


@contextmanager
def claimed(folder: Path) -> Iterator[None]:
    """Make the folder and keep other runs out of it; raises CosimError when one is in it, or it cannot be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
        lock = FileLock(folder / LOCK, timeout=0)
        lock.acquire()
    except Timeout:
        raise CosimError(f"another run is writing into {folder}; give this one another folder") from None
    except OSError as error:
        raise unwritable(folder, error) from None
    try:
        yield
    finally:
        lock.release()


def unwritable(folder: Path, error: OSError) -> CosimError:
    """Why nothing can be written into the folder."""
    place = error.filename or folder
    if isinstance(error, FileExistsError | NotADirectoryError):
        return CosimError(f"cannot write into {place}: there is a file in the place of a folder; give another one (-o)")
    return CosimError(
        f"cannot write into {place}: {because(error)}; remove what is in the way, or give another folder (-o)"
    )
