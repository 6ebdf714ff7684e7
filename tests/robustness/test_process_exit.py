"""A process that used our FMUs ends in peace: PythonFMU's own binary now and then aborts it when all work is done."""

from __future__ import annotations

import random
import subprocess
import sys
from pathlib import Path

import pytest

PROCESSES = 20


@pytest.mark.parametrize("seed", range(PROCESSES))
def test_exit_after_several_fmus(unzipped: dict[str, Path], seed: int) -> None:
    """Several FMUs in some order, every second instance freed, the others left to the end of the process."""
    generator = random.Random(seed)
    folders = generator.sample(sorted(unzipped.values()), generator.randint(2, len(unzipped)))
    done = subprocess.run(
        [sys.executable, "exit_worker.py", *map(str, folders)],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout == f"done {len(folders)} {folders[0].name}\n"


@pytest.mark.nightly
@pytest.mark.parametrize("seed", range(200))
def test_two_hundred_runs_end_in_peace(tmp_path: Path, seed: int) -> None:
    """Whole runs of seven FMUs, each in a process of its own, every fourth with one of them isolated."""
    options = ["--seed", str(seed), "--stop-time", "0.1", "--no-report", "--quiet", "-o", str(tmp_path / "out")]
    isolated = ["--isolate", "plant"] if seed % 4 == 0 else []
    command = [sys.executable, "-m", "cosim", "run", "lateral-tracking", *options, *isolated]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
