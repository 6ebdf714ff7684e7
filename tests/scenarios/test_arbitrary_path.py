"""The road planned while driving, through its FMUs: as fast as it should be, joined, tracked, and inside the road."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scenario_types import Configured, Run

from cosim.errors import CosimError
from cosim.model.parsing import parse_assignments
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load
from fmus.planner.path_road import PathRoad
from tests.references.circuits import circuit

NAME = "arbitrary-path"


def test_within_five_percent_of_the_global_optimum(scenario_run: Run) -> None:
    metrics = scenario_run(NAME).summary.metrics
    assert 1.0 <= metrics["optimum_ratio"].value <= 1.05
    assert metrics["final_time"].value == pytest.approx(metrics["final_time_planned"].value, abs=0.05)
    assert metrics["problems_failed"].value == metrics["fallbacks"].value == 0 and metrics["problems"].value == 14
    assert metrics["planned_ahead_min"].value >= 3.02


def test_reference_is_continuous_at_the_joints(scenario_run: Run) -> None:
    """Between samples 20 ms apart nothing moves that speed, curvature and acceleration do not explain."""
    metrics = scenario_run(NAME).summary.metrics
    assert metrics["joint_position_max"].value <= 0.002
    assert metrics["joint_course_max"].value <= 0.005
    assert metrics["joint_speed_max"].value <= 0.08, "the acceleration itself jumps with the inputs"


def test_controller_follows_and_stays_on_the_road(scenario_run: Run) -> None:
    driven = scenario_run(NAME)
    metrics, results = driven.summary.metrics, driven.results
    assert metrics["lateral_error_max"].value <= 0.15 and metrics["lateral_error_rms"].value <= 0.02
    assert metrics["corridor_violation_max"].value == 0.0
    assert metrics["mpc_unsolved"].value <= 5 and metrics["fallback_count"].value == 0
    time = metrics["final_time"].value
    x = np.interp(time, results.time, results["plant.position.x"])
    assert x == pytest.approx(results.samples("planner", "reference.x")[round(time / 0.02)], abs=1.0)
    assert results["plant.velocity.x"].max() > 30


def test_start_beside_the_plan_is_caught(scenario_run: Run) -> None:
    metrics = scenario_run(NAME, "scenario.lateral_offset=0.3").summary.metrics
    assert metrics["lateral_error_max"].value == pytest.approx(0.3, abs=0.05)
    assert metrics["lateral_error_after_2s"].value <= 0.15


def test_speed_at_the_start_is_told_to_both(scenario_run: Run) -> None:
    results = scenario_run(NAME, "planner.initial.speed=20").results
    assert results["plant.velocity.x"][0] == pytest.approx(20.0) == results["planner.reference.speed"][0]


@pytest.mark.parametrize(
    ("rows", "said"),
    [
        ("0,0,3\n20,0,3\n", "row 2"),
        ("0,0,3,3\n20,0,3\n", "row 3"),
        ("0,0,3,3\n20,nan,3,3\n", "row 3"),
        ("0,0,3,3\n20,inf,3,3\n", "row 3"),
        ("0,0,3,3\n20,far,3,3\n", "row 3"),
        ("", "it must have 2 to 4000"),
        ("0,0,3,3\n20,0,3,3\n40,0,3,3\n", "planner: the road has 3 points; give at least 4"),
    ],
)
def test_a_bad_road_is_told_by_its_row(configured: Configured, rows: str, said: str, tmp_path: Path) -> None:
    file = tmp_path / "road.csv"
    file.write_text(f"x,y,width_left,width_right\n{rows}")
    with pytest.raises(CosimError, match=said):
        configured(NAME, f"planner.road_file={file}")


@pytest.mark.parametrize(
    ("name", "value"),
    [("road.spacing", value) for value in ("0", "1e-12", "nan", "inf", "-3", "wide")]
    + [("road.clearance", value) for value in ("nan", "-1", "wide")],
)
def test_a_bad_number_is_told_before_the_road_is_laid(configured: Configured, name: str, value: str) -> None:
    with pytest.raises(CosimError, match=f"planner.{name} = {value}"):
        configured(NAME, f"planner.{name}={value}")


def test_a_start_beside_the_road_is_one_sentence(configured: Configured) -> None:
    with pytest.raises(CosimError, match=r"^planner: initial.lateral = 3 m leaves the road"):
        configured(NAME, "planner.initial.lateral=3")


def test_the_plan_leaves_room_and_grip_unless_told_otherwise(configured: Configured) -> None:
    usual, told = configured(NAME), configured(NAME, "planner.road.clearance=1", "planner.design.tyre.rear.peak=5000")
    assert usual.number("planner", "road.clearance") == pytest.approx(0.84 + 0.1)
    peak = usual.start("planner", "design.tyre.rear.peak")
    assert usual.number("planner", "design.tyre.rear.peak") == pytest.approx(0.85 * peak)
    assert told.value("planner", "road.clearance") == 1.0
    assert told.value("planner", "design.tyre.rear.peak") == 5000.0


def test_the_picture_is_drawn(scenario_run: Run, tmp_path: Path) -> None:
    scenario_run(NAME).draw(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").stat().st_size > 50_000


def _road(road: PathRoad, file: Path) -> str:
    rows = np.column_stack([road.points, road.widths])
    np.savetxt(file, rows, delimiter=",", header="x,y,width_left,width_right", comments="")
    return f"planner.road_file={file}"


def test_a_planner_that_gives_up_fails_the_run(tmp_path: Path) -> None:
    """At 45 m/s, 40 m before a hairpin of 15 m: no plan, and the run says so."""
    angle = np.linspace(0, np.pi, 12)
    hairpin = np.column_stack([40 + 15 * np.sin(angle), 15 * (1 - np.cos(angle))])
    points = np.vstack([[[0, 0], [10, 0], [20, 0], [30, 0]], hairpin])
    assignments = [_road(PathRoad(points, np.full((16, 2), 3.0)), tmp_path / "road.csv"), "planner.initial.speed=45"]
    request = Request(load(NAME), tmp_path / "out", parse_assignments(assignments), stop_time=1.0)
    summary = run(request).summary
    assert summary.status == "failed" and summary.metrics["planner_gave_up"].value == 1
    assert re.match(r"the planner gave up at 0\.0 s: .* m along the road, of 8\d m, a local problem", summary.reason)


@pytest.mark.nightly
def test_lap_of_a_closed_road_as_published(tmp_path: Path) -> None:
    """The metrics belong to the road that ran: its lap, its optimum, its corridor."""
    road = circuit("chicane")
    rows = np.column_stack([road.points, road.widths[:, ::-1]])
    file = tmp_path / "track.csv"
    np.savetxt(file, rows, delimiter=",", header="x_m,y_m,w_tr_right_m,w_tr_left_m", comments="# ")
    assignments = [f"planner.road_file={file}", "planner.road.closed=true", "planner.initial.speed=12"]
    metrics = run(Request(load(NAME), tmp_path / "out", parse_assignments(assignments), stop_time=60.0)).summary.metrics
    assert metrics["problems_failed"].value == metrics["planner_gave_up"].value == 0
    assert metrics["final_time"].value == pytest.approx(metrics["final_time_planned"].value, abs=0.1)
    assert 0.99 <= metrics["optimum_ratio"].value <= 1.05
    assert metrics["corridor_violation_max"].value <= 0.05
