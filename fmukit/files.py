"""Files that other processes may read and write at the same time."""

from __future__ import annotations

import os
from pathlib import Path
from secrets import token_hex


def write(path: Path, data: bytes) -> Path:
    """Write the file at once or not at all, whatever other processes do."""
    path.parent.mkdir(parents=True, exist_ok=True)
    temporary = path.with_name(f".{path.name}-{token_hex(8)}")
    try:
        with temporary.open("xb") as file:  # never through a link that somebody has put there
            file.write(data)
        os.replace(temporary, path)
    except BaseException:
        temporary.unlink(missing_ok=True)
        raise
    return path
