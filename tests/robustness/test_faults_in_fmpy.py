"""Every FMU faulted and freed a hundred times in FMPy, in a process of its own: no crash, every fault discarded."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from fmus import CATALOGUE

CYCLES = 100


@pytest.mark.parametrize("name", [component.interface.name for component in CATALOGUE])
def test_hundred_faults_and_frees(unzipped: dict[str, Path], name: str) -> None:
    done = subprocess.run(
        [sys.executable, "faults_worker.py", str(unzipped[name]), str(CYCLES)],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=False,
        timeout=300,
    )
    assert done.returncode == 0, f"{done.returncode}: {done.stderr[-2000:]}"
    assert done.stdout.splitlines()[-1] == f"done {CYCLES}"
