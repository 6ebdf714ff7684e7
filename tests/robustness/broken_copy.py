"""Copies of an FMU with a fault put into its runtime: to see that the tests would notice."""

from __future__ import annotations

import shutil
from pathlib import Path


def copy_with(folder: Path, original: Path, module: str, before: str, inserted: str) -> None:
    """Copy the unzipped FMU to `folder` with lines inserted into one module, before the only place with that text."""
    shutil.copytree(original, folder)
    (path,) = (folder / "resources").glob(f"*/runtime/{module}")
    text = path.read_text("utf-8")
    assert text.count(before) == 1
    path.write_text(text.replace(before, f"{inserted}\n{before}"), "utf-8")
