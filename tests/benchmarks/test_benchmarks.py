"""`python -m benchmarks` runs from end to end; its figures are for humans to judge, with more rounds.

`test_limits.py` fails when they are far from their aims.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks import formation_scaling

ROOT = Path(__file__).parents[2]


def _benchmarks(*arguments: str) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "benchmarks", *arguments]
    wide = os.environ | {"COLUMNS": "200"}
    return subprocess.run(line, cwd=ROOT, env=wide, capture_output=True, text=True, check=False)


@pytest.mark.nightly
def test_one_round_fills_the_table() -> None:
    done = _benchmarks("--rounds", "1")
    assert done.returncode == 0, done.stderr
    plans = ("plan, gate grid, m = 160", "plan, time grid, m = 80", "plain CasADi", "IPOPT against fatrop")
    programs = ("prediction, 275", "force distribution, 4", "FMU: prediction", "FMU: force", "MpcAllocator: compiled")
    others = ("set + 1 ms step + get", "one RK4 step with tyres", "recorder on", "share of the master")
    formations = [f"formation of {cars} car" for cars in formation_scaling.SIZES]
    for figure in (*others, *formations, *plans, *programs):
        (line,) = [line for line in done.stdout.splitlines() if figure in line]
        found = re.search(r"│\s*([0-9.]+)\s*(?:%|s|ms|us)?\s*│", line)
        assert found, line
        assert float(found[1]) > 0.0
    assert ("load average" in done.stdout) == hasattr(os, "getloadavg")


def test_rounds_must_be_positive() -> None:
    done = _benchmarks("--rounds", "0")
    assert done.returncode == 2
    assert "--rounds" in done.stderr
