"""Models that have been built once need no compiler any more."""

import json
import os
import subprocess
import sys

from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load


def test_a_warm_cache_needs_no_compiler(tmp_path):
    run(Request(load("lateral-tracking"), tmp_path / "warm", stop_time=0.05))
    done = subprocess.run(
        [sys.executable, "-m", "cosim", "run", "lateral-tracking", "--stop-time", "0.05", "-o", str(tmp_path / "cold")],
        env={**os.environ, "CC": "/nonexistent"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    made = [json.loads((tmp_path / name / "summary.json").read_text())["provenance"] for name in ("warm", "cold")]
    assert made[0]["models"] == made[1]["models"]
    assert made[1]["versions"]["compiler"] == ""
