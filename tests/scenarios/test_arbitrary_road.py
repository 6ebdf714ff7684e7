"""What arbitrary-path is measured by is the road and the limits its planner was given: made-up drives, closed forms."""

from __future__ import annotations

import logging
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from scenario_types import Configured, Run

from cosim.results.reading import Facts, Results
from scenarios.arbitrary_path.metrics import crossing, optimal_time, planned_ahead, violation
from scenarios.arbitrary_path.road import LaidRoad, lay

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


@pytest.fixture
def laid(configured: Configured, straight: str) -> Callable[..., LaidRoad]:
    """laid("variable=value", ...): the straight road of a planner with these values."""

    def made(*assignments: str) -> LaidRoad:
        file = f"planner.road_file={straight}"
        return lay(configured("arbitrary-path", file, *(f"planner.{assignment}" for assignment in assignments)))

    return made


def drive(left: float, beyond: float) -> Results:
    """Beside the centre line from 10 m on, at constant speed, and `beyond` [m] beside it behind the end of the road."""
    time = np.arange(0.0, 6.0, 0.01)
    s = 10.0 + SPEED * time
    points = np.outer(s, AHEAD) + np.outer(np.where(s < LENGTH, left, beyond), LEFT)
    table = pa.table({"time": time, "plant.position.x": points[:, 0], "plant.position.y": points[:, 1]})
    return Results(table, Facts({}))


@pytest.mark.parametrize("clearance", [0.0, 0.84, 1.0])
@pytest.mark.parametrize(("left", "outside"), [(0.5, 0.0), (2.5, 0.34), (-1.16, 0.0), (-1.5, 0.34)])
def test_a_road_file_is_what_is_driven(
    laid: Callable[..., LaidRoad], clearance: float, left: float, outside: float
) -> None:
    """Half the width of the car is 0.84 m, whatever the plan keeps; where it is when it passes the end decides."""
    way, results = laid(f"road.clearance={clearance}"), drive(left, beyond=0.0)
    end, time = crossing(results, way)
    assert time == pytest.approx((LENGTH - 10.0) / SPEED, abs=1e-9)
    assert results.time[end] == pytest.approx(time, abs=0.011)
    assert violation(results, way, end) == pytest.approx(outside, abs=1e-9)


def test_passing_the_end_beside_the_road_is_not_arriving(laid: Callable[..., LaidRoad]) -> None:
    way, results = laid(), drive(0.0, beyond=4.0)
    end, time = crossing(results, way)
    assert end == len(results.time)
    assert np.isnan(time)
    assert violation(results, way, end) == pytest.approx(4.0 - (3.0 - 0.84), abs=1e-9)


def test_optimum_is_that_of_the_limits_set(laid: Callable[..., LaidRoad]) -> None:
    """Straight on at the largest speed from the start."""
    time = optimal_time(laid(f"limit.speed={SPEED}", f"initial.speed={SPEED}"))
    assert time == pytest.approx(LENGTH / SPEED, rel=1e-4)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (("end.speed=10",), "faster than planner.end.speed"),
        (("initial.speed=60", "limit.speed=20"), "cannot be planned"),
    ],
)
def test_an_optimum_that_cannot_be_compared_is_unknown(
    laid: Callable[..., LaidRoad], given: tuple[str, ...], said: str, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.INFO, "cosim"):
        assert np.isnan(optimal_time(laid(*given)))
    assert said in caplog.messages[-1]
    assert caplog.messages[-1].startswith("optimum_time is unknown: ")


def test_a_closed_road_is_compared_with_a_lap(configured: Configured, tmp_path: Path) -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 36, endpoint=False)
    write(tmp_path / "ring.csv", 60.0 * np.column_stack([np.cos(angle), np.sin(angle)]), 3.0, 3.0)
    ring = lay(configured("arbitrary-path", f"planner.road_file={tmp_path / 'ring.csv'}", "planner.road.closed=true"))
    inside = 60.0 - 3.0 + 0.84
    assert 2 * np.pi * inside / np.sqrt(6.8 * inside) < optimal_time(ring) < 2 * np.pi * 60.0 / 15.0, "begun at 15 m/s"
    results = drive(0.0, beyond=0.0)
    end, time = crossing(results, ring)
    assert end == len(results.time)
    assert np.isnan(time)


def test_a_hairpin_is_compared_with_its_own_optimum(scenario_run: Run, tmp_path: Path) -> None:
    """Its end lies beside its start: only where along the road the car is tells what it has passed."""
    s, turn = np.arange(0.0, 121.0, 10.0), np.linspace(0.0, np.pi, 11)[1:-1]
    there, back = np.column_stack([s, 0 * s]), np.column_stack([s[::-1], 0 * s + 60.0])
    bend = np.column_stack([120.0 + 30.0 * np.sin(turn), 30.0 - 30.0 * np.cos(turn)])
    write(tmp_path / "hairpin.csv", np.vstack([there, bend, back]), 4.0, 4.0)
    metrics = scenario_run("arbitrary-path", f"planner.road_file={tmp_path / 'hairpin.csv'}").summary.metrics
    assert metrics["final_time"].value == pytest.approx(metrics["final_time_planned"].value, abs=0.05)
    assert 1.0 <= metrics["optimum_ratio"].value <= 1.05
    assert metrics["corridor_violation_max"].value <= 0.3, "the plan cuts the corner between its gates"


def test_nothing_left_to_plan_is_no_time_planned_ahead() -> None:
    """A drive that begins when all is planned."""
    time = np.arange(0.0, 1.0, 0.02)
    table = {"time": time, "planner.plan.phase": np.ones_like(time), "planner.plan.end_time": 5.0 + time}
    assert np.isnan(planned_ahead(Results(pa.table(table), Facts({"planner": 0.02}))))


def test_times_and_jumps_have_their_units(scenario_run: Run) -> None:
    metrics = scenario_run("arbitrary-path").summary.metrics
    units = {"optimum_time": "s", "planned_ahead_min": "s", "joint_course_max": "rad", "optimum_ratio": "1"}
    assert {name: metrics[name].unit for name in units} == units


def test_drawn_edges_are_those_of_the_file(laid: Callable[..., LaidRoad]) -> None:
    s = np.linspace(0.0, LENGTH, 7)[:, None]
    for edge, side in zip(laid().path.edges(7), (3.0, -2.0), strict=True):
        np.testing.assert_allclose(edge, s * AHEAD + side * LEFT, atol=1e-9)


def test_a_first_point_repeated_at_the_end_of_a_ring_is_one_point(
    configured: Configured, tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """As files are published; without `closed` a ring is driven as it is asked for, and that is told."""
    angle = np.linspace(0.0, 2 * np.pi, 61)
    write(tmp_path / "ring.csv", 60 * np.column_stack([np.cos(angle), np.sin(angle)]), 4.0, 4.0)
    file = f"planner.road_file={tmp_path / 'ring.csv'}"
    lap = lay(configured("arbitrary-path", file, "planner.road.closed=true"))
    assert lap.path.curve()[0](0.0) == pytest.approx([60.0, 0.0])
    assert not caplog.messages
    lay(configured("arbitrary-path", file))
    assert caplog.messages[-1].startswith("the road ends where it begins, but is driven as open")
