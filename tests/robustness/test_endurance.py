"""Thousands of lives of an FMU in one process leave nothing behind but what PythonFMU's binary itself leaks."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from broken_copy import copy_with

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
MEMORY = 2000  # bytes per life


def lives(folder: Path, cycles: int, temporary: Path, kind: str = "good") -> dict[str, int]:
    """What `cycles` lives left behind."""
    done = subprocess.run(
        [sys.executable, "endurance_worker.py", str(folder), str(cycles), kind],
        cwd=Path(__file__).parent,
        env={**os.environ, "TMPDIR": str(temporary)},
        capture_output=True,
        text=True,
        check=False,
        timeout=900,
    )
    assert done.returncode == 0, f"{done.returncode}: {done.stderr[-2000:]}"
    found: dict[str, int] = json.loads(done.stdout)
    return found


def check(found: dict[str, int], cycles: int, heap: int = 0) -> None:
    """`heap` [bytes] is room for the steps in which the allocator grows, which few lives do not average out."""
    assert found.pop("memory") < MEMORY * cycles + heap
    assert found == {"handles": 0, "threads": 0, "path": 0, "files": 0, "library": 0}


def test_three_hundred_lives_of_the_plant(unzipped: dict[str, Path], tmp_path: Path) -> None:
    check(lives(unzipped["Vehicle16Dof"], 300, tmp_path), 300, heap=300_000)


@pytest.mark.nightly
def test_two_thousand_lives_of_the_plant(unzipped: dict[str, Path], tmp_path: Path) -> None:
    check(lives(unzipped["Vehicle16Dof"], 2000, tmp_path), 2000)


@pytest.mark.parametrize("name", ["Vehicle16Dof", "NavigationFilter"])
def test_three_hundred_mixed_lives(unzipped: dict[str, Path], tmp_path: Path, name: str) -> None:
    check(lives(unzipped[name], 300, tmp_path, "mixed"), 300, heap=300_000)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["Vehicle16Dof", "NavigationFilter"])
def test_ten_thousand_mixed_lives(unzipped: dict[str, Path], tmp_path: Path, name: str) -> None:
    check(lives(unzipped[name], 10_000, tmp_path, "mixed"), 10_000)


def test_a_leak_would_be_seen(unzipped: dict[str, Path], tmp_path: Path) -> None:
    """The measurement itself: 4 kB lost in every life are found."""
    folder, temporary = tmp_path / "Imu", tmp_path / "temporary"
    temporary.mkdir()
    leak = "    lost = []\n\n    def __del__(self):\n        self.lost.append(b'x' * (4000 + len(self.lost)))\n"
    copy_with(folder, unzipped["Imu"], "slave.py", "    # life cycle", leak)
    assert lives(folder, 300, temporary)["memory"] > 2 * MEMORY * 300
