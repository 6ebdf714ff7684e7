"""Temporary folders of processes that were killed are swept, those of the living never."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from time import time

from fmukit.scratch import LOCK, scratch

LONG_AGO = time() - 3600.0
HOLDER = """
import sys
from pathlib import Path
from fmukit.scratch import scratch
with scratch("cosim-", Path(sys.argv[1])) as folder:
    print(folder, flush=True)
    input()
"""


def held(place: Path) -> tuple[subprocess.Popen[str], Path]:
    """A process that holds a folder, and the folder, which looks old."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
    process = subprocess.Popen([sys.executable, "-c", HOLDER, str(place)], cwd=Path(__file__).parents[2], **pipes)
    assert process.stdout is not None
    folder = Path(process.stdout.readline().strip())
    os.utime(folder / LOCK, (LONG_AGO, LONG_AGO))
    return process, folder


def ended(process: subprocess.Popen[str]) -> None:
    process.kill()
    process.communicate()


def test_it_is_gone_in_the_end(tmp_path: Path) -> None:
    with scratch("cosim-", tmp_path) as folder:
        (folder / "file").write_text("")
        assert folder.parent == tmp_path
    assert not list(tmp_path.iterdir())


def test_what_the_living_hold_stays_and_what_the_dead_left_goes(tmp_path: Path) -> None:
    (process, folder), (other, left) = held(tmp_path), held(tmp_path)
    ended(other)
    (left / "big").write_bytes(b"x")
    with scratch("cosim-", tmp_path) as own:
        assert {path.name for path in tmp_path.iterdir()} == {folder.name, own.name}
    ended(process)


def test_what_is_young_or_has_no_lock_or_is_a_link_stays(tmp_path: Path) -> None:
    """A lock file may be there before its lock; a folder without one may be anybody's."""
    for name in ("cosim-young", "cosim-other", "elsewhere"):
        (tmp_path / name).mkdir()
    for folder in ("cosim-young", "elsewhere"):
        (tmp_path / folder / LOCK).touch()
    os.utime(tmp_path / "elsewhere" / LOCK, (LONG_AGO, LONG_AGO))
    (tmp_path / "cosim-link").symlink_to(tmp_path / "elsewhere")
    before = set(tmp_path.iterdir())
    with scratch("cosim-", tmp_path):
        pass
    assert set(tmp_path.iterdir()) == before
    assert (tmp_path / "elsewhere" / LOCK).exists()
