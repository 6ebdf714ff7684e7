"""Filters on kinematic vehicles, whose accelerations jump with every command: no fix is refused, however they brake."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.model.parsing import parse_assignments
from cosim.run.request import Request
from cosim.run.running import Finished, run
from cosim.scenario.discovery import load

LIGHT = "scenario.plant=unicycle"
BRAKING = ("scenario.manoeuvre=braking", "scenario.vehicles=4")
HARD, CALM = 2.0, 0.5
"""Accelerations [m/s2] above and below which a car brakes or accelerates hard, and cruises."""


def drive(name: str, folder: Path, *assignments: str, stop: float | None = None) -> Finished:
    finished = run(Request(load(name), folder, parse_assignments((LIGHT, *assignments)), stop_time=stop))
    assert finished.summary.status == "ok", finished.summary.reason
    return finished


def check_no_fix_was_refused(finished: Finished, caplog: pytest.LogCaptureFixture) -> None:
    results = finished.results
    counts = {n: results[n][-1] for n in results.names if n.endswith(".fix.refused_count")}
    assert len(counts) > 1
    assert not any(counts.values()), counts
    assert not [r for r in caplog.records if "fixes have been refused" in r.getMessage()]


def innovations(finished: Finished, least: float, most: float) -> np.ndarray:
    """NIS of all new fixes of all cars taken while the size of the acceleration was between the two [m/s2]."""
    results, found = finished.results, []
    for name in (n for n in results.names if n.endswith(".gps.gps.fix_count")):
        car, new = name.split(".")[0], np.diff(results[name], prepend=0.0) > 0
        size = np.abs(results[f"{car}.plant.acceleration.x"])
        rows = new & (size > least) & (size < most) & (results.time > 1.0)
        found += [results[f"{car}.filter.nis.{part}"][rows] for part in ("position", "velocity")]
    return np.concatenate(found)


@pytest.mark.parametrize("law", ["adaptive", "constraint"])
def test_innovations_of_a_platoon_are_as_believed_while_it_brakes_hard(
    law: str, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    finished = drive("platoon", tmp_path, *BRAKING, f"scenario.law={law}", stop=24.0)
    check_no_fix_was_refused(finished, caplog)
    for span in ((HARD, np.inf), (0.0, CALM)):
        nis = innovations(finished, *span)
        assert len(nis) > 300
        assert abs(nis.mean() - 2) < 3 * np.sqrt(2 * 2 / len(nis))


def test_a_star_that_brakes_hard_refuses_no_fix(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    star = ("scenario.topology=star", "scenario.headway=0")
    check_no_fix_was_refused(drive("platoon", tmp_path, *BRAKING, *star, stop=24.0), caplog)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["platoon", "formation-adaptive", "formation-constraint"])
def test_no_fix_is_refused_in_whole_runs(name: str, tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    check_no_fix_was_refused(drive(name, tmp_path), caplog)
