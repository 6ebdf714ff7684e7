"""What arbitrary-path is measured by is the road and the limits its planner was given: made-up drives, closed forms."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest

from cosim.command.display import show
from cosim.results.reading import Results
from scenarios.arbitrary_path import road as _arbitrary_road
from scenarios.arbitrary_path.metrics import crossing, optimal_time, planned_ahead, violation

LENGTH, COURSE, SPEED = 100.0, 0.5, 20.0
AHEAD, LEFT = np.array([np.cos(COURSE), np.sin(COURSE)]), np.array([-np.sin(COURSE), np.cos(COURSE)])


def write(file: Path, points: np.ndarray, left: float, right: float) -> None:
    """A road file of the points (n, 2) with the same widths everywhere."""
    rows = np.column_stack([points, np.tile([left, right], (len(points), 1))])
    np.savetxt(file, rows, "%.12g", ",", header="x,y,width_left,width_right", comments="")


@pytest.fixture
def straight(tmp_path: Path) -> str:
    """A road of 100 m with 3 m to the left and 2 m to the right."""
    write(tmp_path / "road.csv", np.outer(np.linspace(0.0, LENGTH, 11), AHEAD), 3.0, 2.0)
    return str(tmp_path / "road.csv")


def drive(left: float, beyond: float) -> Results:
    """Beside the centre line from 10 m on, at constant speed, and `beyond` [m] beside it behind the end of the road."""
    time = np.arange(0.0, 6.0, 0.01)
    s = 10.0 + SPEED * time
    points = np.outer(s, AHEAD) + np.outer(np.where(s < LENGTH, left, beyond), LEFT)
    return Results(pa.table({"time": time, "plant.position.x": points[:, 0], "plant.position.y": points[:, 1]}), {})


@pytest.mark.parametrize("clearance", [0.0, 0.84, 1.0])
@pytest.mark.parametrize(("left", "outside"), [(0.5, 0.0), (2.5, 0.34), (-1.16, 0.0), (-1.5, 0.34)])
def test_a_road_file_is_what_is_driven(straight: str, clearance: float, left: float, outside: float) -> None:
    """Half the width of the car is 0.84 m, whatever the plan keeps; where it is when it passes the end decides."""
    p = _arbitrary_road.parameters({"road_file": straight, "road.clearance": clearance})
    results = drive(left, beyond=0.0)
    end, time = crossing(results, p)
    assert time == pytest.approx((LENGTH - 10.0) / SPEED, abs=1e-9)
    assert results.time[end] == pytest.approx(time, abs=0.011)
    assert violation(results, p, end) == pytest.approx(outside, abs=1e-9)


def test_passing_the_end_beside_the_road_is_not_arriving(straight: str) -> None:
    p = _arbitrary_road.parameters({"road_file": straight})
    results = drive(0.0, beyond=4.0)
    end, time = crossing(results, p)
    assert end == len(results.time)
    assert np.isnan(time)
    assert violation(results, p, end) == pytest.approx(4.0 - (3.0 - 0.84), abs=1e-9)


def test_optimum_is_that_of_the_limits_set(straight: str) -> None:
    """Straight on at the largest speed from the start."""
    p = _arbitrary_road.parameters({"road_file": straight, "limit.speed": SPEED, "initial.speed": SPEED})
    assert optimal_time(p) == pytest.approx(LENGTH / SPEED, rel=1e-4)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"road.closed": True}, "a closed road has no end"),
        ({"end.speed": 10.0}, "faster than planner.end.speed"),
        ({"initial.speed": 60.0, "limit.speed": 20.0}, "cannot be planned"),
    ],
)
def test_an_optimum_that_cannot_be_compared_is_unknown(
    straight: str, given: dict[str, float], said: str, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, "cosim"):
        assert np.isnan(optimal_time(_arbitrary_road.parameters({"road_file": straight, **given})))
    assert said in caplog.messages[-1]
    assert caplog.messages[-1].startswith("optimum_time is unknown: ")


def test_a_hairpin_is_compared_with_its_own_optimum(scenario_run, tmp_path: Path) -> None:
    """Its end lies beside its start: only where along the road the car is tells what it has passed."""
    s, turn = np.arange(0.0, 121.0, 10.0), np.linspace(0.0, np.pi, 11)[1:-1]
    there, back = np.column_stack([s, 0 * s]), np.column_stack([s[::-1], 0 * s + 60.0])
    bend = np.column_stack([120.0 + 30.0 * np.sin(turn), 30.0 - 30.0 * np.cos(turn)])
    write(tmp_path / "hairpin.csv", np.vstack([there, bend, back]), 4.0, 4.0)
    metrics = scenario_run("arbitrary-path", f"planner.road_file={tmp_path / 'hairpin.csv'}")[0]["metrics"]
    assert metrics["final_time"] == pytest.approx(metrics["final_time_planned"], abs=0.05)
    assert 1.0 <= metrics["optimum_ratio"] <= 1.05
    assert metrics["corridor_violation_max"] <= 0.3, "the plan cuts the corner between its gates"


def test_nothing_left_to_plan_is_no_time_planned_ahead() -> None:
    """A drive that begins when all is planned."""
    time = np.arange(0.0, 1.0, 0.02)
    table = {"time": time, "planner.plan.phase": np.ones_like(time), "planner.plan.end_time": 5.0 + time}
    assert np.isnan(planned_ahead(Results(pa.table(table), {"planner": 0.02})))


def test_times_and_jumps_are_shown_with_their_units(scenario_run, capsys: pytest.CaptureFixture[str]) -> None:
    show(scenario_run("arbitrary-path")[0], Path())
    lines = capsys.readouterr().out.splitlines()
    for name, unit in (("optimum_time", "s"), ("planned_ahead_min", "s"), ("joint_course_max", "deg")):
        assert [line.split()[5] for line in lines if name in line] == [unit]


def test_drawn_edges_are_those_of_the_file(straight: str) -> None:
    road = _arbitrary_road.path_road(_arbitrary_road.parameters({"road_file": straight}), 0.0)
    s = np.linspace(0.0, LENGTH, 7)[:, None]
    for edge, side in zip(road.edges(7), (3.0, -2.0), strict=True):
        np.testing.assert_allclose(edge, s * AHEAD + side * LEFT, atol=1e-9)
