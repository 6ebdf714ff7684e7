"""Runs that are killed at any moment: what is left can be read, no process stays, and the next run is undisturbed."""

from __future__ import annotations

import os
import random
import secrets
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from cosim.results.reading import load_results
from fmukit.guard.keeper import processes

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
KILLS = 42
COMMAND = [sys.executable, "-m", "cosim", "run", "lateral-tracking", "--stop-time", "2", "--quiet", "--no-report", "-o"]


def started(folder: Path, *more: str, **environment: str) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [*COMMAND, str(folder), *more],
        env={**os.environ, **environment},
        cwd=Path(__file__).parents[2],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )


def finished(folder: Path, *more: str) -> float:
    """How long a run took [s]; it must end well."""
    began = time.monotonic()
    with started(folder, *more) as process:
        _, said = process.communicate()
    assert process.returncode == 0, said
    return time.monotonic() - began


@pytest.mark.nightly
@pytest.mark.parametrize("more", [(), ("--isolate", "all")], ids=["together", "isolated"])
def test_kills_at_any_moment(more: tuple[str, ...], tmp_path: Path) -> None:
    generator = random.Random(len(more))
    finished(tmp_path / "undisturbed", *more)
    whole = finished(tmp_path / "undisturbed", *more)
    expected = load_results(tmp_path / "undisturbed")
    killed = partial = 0
    for _ in range(KILLS // 2):
        mark = secrets.token_hex(8)
        with started(tmp_path / "killed", *more, KILLED_RUN=mark) as process:
            time.sleep(generator.uniform(0.0, whole))
            process.send_signal(signal.SIGKILL)
            process.wait()
        killed += process.returncode == -signal.SIGKILL
        until = time.monotonic() + 20.0
        while processes.bearing(f"KILLED_RUN={mark}") and time.monotonic() < until:
            time.sleep(0.05)
        assert processes.bearing(f"KILLED_RUN={mark}") == []
        if list((tmp_path / "killed").glob("results.*")):
            results = load_results(tmp_path / "killed")
            partial += 0 < len(results.time) < len(expected.time)
            assert results.time.tolist() == expected.time[: len(results.time)].tolist()
    assert killed >= KILLS // 2 - 4
    finished(tmp_path / "killed", *more)
    again = load_results(tmp_path / "killed")
    assert again.time.tolist() == expected.time.tolist()
    assert all(np.array_equal(again[name], expected[name], equal_nan=True) for name in expected.names)
    print(f"{killed} killed, {partial} of them left a part of the results")
