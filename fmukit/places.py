"""Where FMUs may be unpacked: PythonFMU's library reads a resource location whose only escape is %20."""

from __future__ import annotations

import os
import re
import tempfile
from collections.abc import Iterator
from pathlib import Path

from fmukit.errors import UserError

_PLAIN = re.compile(r"[A-Za-z0-9._~/\\: -]*")


def is_plain(folder: Path) -> bool:
    """Whether no character of the path but a blank is escaped in a URI."""
    return bool(_PLAIN.fullmatch(str(folder)))


def unpacking_folder() -> Path:
    """The folder for temporary files, or another one if its path is not plain; raises UserError if there is none."""
    for folder in _candidates():
        if is_plain(folder) and folder.is_dir() and os.access(folder, os.W_OK | os.X_OK):
            return folder
    raise UserError(
        f"FMUs cannot be unpacked into {tempfile.gettempdir()}: PythonFMU's library reads only paths of plain letters, "
        "digits, blanks and . _ ~ -; set TMPDIR to such a folder"
    )


def _candidates() -> Iterator[Path]:
    yield Path(tempfile.gettempdir()).resolve()
    yield from (Path("/tmp"), Path("/var/tmp"), Path("/dev/shm"))
    yield Path(os.environ.get("SYSTEMROOT", "")) / "Temp"
    yield Path.cwd()
