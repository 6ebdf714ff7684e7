"""How exact a plan is: end times as the mesh grows finer, and the same problem by collocation."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.cars.published import single_track
from fmus.planner.hocp import Grid, PlanSettings, plan
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from tests.references.collocation import final_time
from tests.references.refinement import refine

CAR = two_wheel_drive(single_track())
ROAD = double_lane_change()


def test_collocation_finds_the_same_end_time() -> None:
    found = plan(CAR, ROAD, 80, settings=PlanSettings(grid="time", smoothing=0.0))
    assert found.final_time == pytest.approx(final_time(single_track(), ROAD, 80), abs=5e-4)
    assert found.final_time == pytest.approx(7.1870, abs=5e-4)


def test_end_times_converge() -> None:
    """The road holds at the nodes only, so the end time rises with m, by less and less."""
    plans = refine(CAR, ROAD, (20, 40, 80), settings=PlanSettings(grid="time"))
    rise = np.diff([found.final_time for found in plans])
    assert (rise > 0).all() and rise[1] < 0.6 * rise[0]
    assert (np.diff([found.violation for found in plans]) < 0).all()
    assert (np.diff([found.replay_error() for found in plans]) < 0).all()


@pytest.mark.nightly
@pytest.mark.parametrize("grid", ["gate", "time"])
def test_end_times_converge_further(grid: Grid) -> None:
    plans = refine(CAR, ROAD, (40, 80, 160, 320), settings=PlanSettings(grid=grid))
    times = [found.final_time for found in plans]
    assert times[2] - times[1] < 2e-3 and 0 < times[3] - times[2] < 0.75 * (times[2] - times[1])
    assert plans[-1].violation < 0.02
    assert plans[-1].replay_error() < 1e-6


def test_substeps_make_no_difference() -> None:
    two, eight = (plan(CAR, ROAD, 80, settings=PlanSettings(substeps=substeps)).final_time for substeps in (2, 8))
    assert two == pytest.approx(eight, abs=1e-6)
