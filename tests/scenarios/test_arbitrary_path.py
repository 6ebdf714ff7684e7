"""The road planned while driving, through its FMUs: as fast as it should be, joined, tracked, and inside the road."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.scenario import configured
from scenarios import load

NAME = "arbitrary-path"


def test_within_five_percent_of_the_global_optimum(scenario_run) -> None:
    metrics = scenario_run(NAME)[0]["metrics"]
    assert 1.0 <= metrics["optimum_ratio"] <= 1.05
    assert metrics["final_time"] == pytest.approx(metrics["final_time_planned"], abs=0.05)
    assert metrics["problems_failed"] == metrics["fallbacks"] == 0 and metrics["problems"] == 14
    assert metrics["planned_ahead_min"] >= 3.02


def test_reference_is_continuous_at_the_joints(scenario_run) -> None:
    """Between samples 20 ms apart nothing moves that speed, curvature and acceleration do not explain."""
    metrics = scenario_run(NAME)[0]["metrics"]
    assert metrics["joint_position_max"] <= 0.002
    assert metrics["joint_course_max"] <= 0.005
    assert metrics["joint_speed_max"] <= 0.08, "the acceleration itself jumps with the inputs"


def test_controller_follows_and_stays_on_the_road(scenario_run) -> None:
    _, results = scenario_run(NAME)
    metrics = scenario_run(NAME)[0]["metrics"]
    assert metrics["lateral_error_max"] <= 0.15 and metrics["lateral_error_rms"] <= 0.02
    assert metrics["corridor_violation_max"] == 0.0
    assert metrics["mpc_unsolved"] <= 5 and metrics["fallback_count"] == 0
    x = np.interp(metrics["final_time"], results.time, results["plant.position.x"])
    assert x == pytest.approx(results.samples("planner", "reference.x")[round(metrics["final_time"] / 0.02)], abs=1.0)
    assert results["plant.velocity.x"].max() > 30


def test_start_beside_the_plan_is_caught(scenario_run) -> None:
    metrics = scenario_run(NAME, "scenario.lateral_offset=0.3")[0]["metrics"]
    assert metrics["lateral_error_max"] == pytest.approx(0.3, abs=0.05)
    assert metrics["lateral_error_after_2s"] <= 0.15


def test_speed_at_the_start_is_told_to_both(scenario_run) -> None:
    _, results = scenario_run(NAME, "planner.initial.speed=20")
    assert results["plant.velocity.x"][0] == pytest.approx(20.0) == results["planner.reference.speed"][0]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("0,0,3\n20,0,3\n", "line 2"),
        ("0,0,3,3\n20,0,3\n", "line 3"),
        ("0,0,3,3\n20,nan,3,3\n", "line 3"),
        ("0,0,3,3\n20,inf,3,3\n", "line 3"),
        ("0,0,3,3\n20,far,3,3\n", "line 3"),
        ("", "give at least 4"),
    ],
)
def test_a_bad_road_is_told_by_its_line(rows: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "road.csv"
    file.write_text(f"x,y,width_left,width_right\n{rows}")
    with pytest.raises(CosimError, match=said):
        configured(load(NAME), [("planner.road_file", str(file))])


@pytest.mark.parametrize(
    ("name", "value"),
    [("road.spacing", value) for value in ("0", "1e-12", "nan", "inf", "-3", "wide")]
    + [("road.clearance", value) for value in ("nan", "-1", "wide")],
)
def test_a_bad_number_is_told_before_the_road_is_laid(name: str, value: str) -> None:
    with pytest.raises(CosimError, match=f"planner.{name} = {value}"):
        configured(load(NAME), [(f"planner.{name}", value)])
