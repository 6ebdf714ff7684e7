"""Where cars start: a trajectory that cannot be played is refused before anything runs, in the words of its player."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load
from fmus.controllers.reference.interface import INTERFACE as REFERENCE
from scenarios.shared import start
from scenarios.shared.tables import read_columns
from scenarios.shared.trajectory_check import check_trajectory

HEADER = "time,x,y,course,speed,acceleration,curvature\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (None, r"table .*t\.csv cannot be read .*No such file or directory.*; give the path of a CSV file"),
        (HEADER, "has 0 rows; it must have 2 to"),
        (
            "time,x,y,course\n0,0,0,0\n",
            "must start with the line time,x,y,course,speed,acc.*, not time,x,y,course$",
        ),
        (HEADER + "0,0,zero,0,20,0,0\n1,20,0,0,20,0,0\n", "row 2: expected 7 finite numbers, got 0,0,zero"),
        (HEADER + "0,0\n1,20,0,0,20,0,0\n", "row 2: expected 7 finite numbers, got 0,0"),
        (HEADER + "1,0,0,0,20,0,0\n1,20,0,0,20,0,0\n", "row 3: time must increase"),
    ],
)
def test_trajectory_files(tmp_path: Path, text: str | None, sentence: str) -> None:
    file = tmp_path / "t.csv"
    if text is not None:
        file.write_text(text)
    request = Request(load("lateral-tracking"), tmp_path / "out", [("reference.trajectory_file", str(file))])
    with pytest.raises(CosimError, match=sentence):
        run(request)
    assert not (tmp_path / "out").exists(), "nothing has run"


def line(speed: float = 15.0, course: float = 0.5, begin: float = 0.0, factor: float = 1.0, turned: float = 0.0) -> str:
    """Straight on for 12 s; what the columns say is `factor` times the speed and `turned` more than the course."""
    rows = []
    for k in range(121):
        t, s = begin + 0.1 * k, 0.1 * k * speed
        x, y = s * math.cos(course), s * math.sin(course)
        rows.append(f"{t:.9g},{x:.9g},{y:.9g},{course + turned:.9g},{factor * speed:.9g},0,0\n")
    return HEADER + "".join(rows)


@pytest.mark.parametrize("begin", [2.0, 100.0, -2.0, -2.03])
def test_a_trajectory_that_does_not_begin_at_zero(
    tmp_path: Path, begin: float, caplog: pytest.LogCaptureFixture
) -> None:
    """The car starts where the reference is at time 0, as its player has it, and the user is told."""
    file = tmp_path / "t.csv"
    file.write_text(line(begin=begin))
    point = start.point_at_zero(str(file))
    assert f"begins at {begin:g} s" in caplog.text
    expected = -begin * 15 * np.array([math.cos(0.5), math.sin(0.5)])
    assert point == pytest.approx((*expected, 0.5, 15.0), abs=1e-6)


def checked(text: str, tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    file.write_text(text)
    check_trajectory("t.csv", read_columns(str(file), REFERENCE))


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (line(factor=3.6), r"t\.csv: .* drives 3\.6 times as far .* seems to be in km/h, give m/s"),
        (line(factor=2.0), r"drives 2 times as far as by x and y over time; give time in s"),
        (line(turned=math.degrees(0.5) - 0.5), r"move at 0\.50 rad, its course is 28\.65; it seems to be in degrees"),
        (line(turned=math.pi / 2 - 1.0), r"its course is 1\.071; it seems to count clockwise"),
        (line(turned=1.8), r"give the direction of motion from the x axis"),
    ],
)
def test_columns_that_contradict_x_and_y(tmp_path: Path, text: str, sentence: str) -> None:
    with pytest.raises(CosimError, match=sentence):
        checked(text, tmp_path)


def test_degrees_on_a_road_that_is_mostly_straight(tmp_path: Path) -> None:
    """One lane change in a minute along the x axis: all other rows have the course 0, in any unit."""
    time = np.arange(0, 60, 0.05)
    lateral = 3.5 / (1 + np.exp(-2 * (time - 30)))
    course = np.degrees(np.arctan2(np.gradient(lateral, time), 15.0))
    rows = (f"{t:.3f},{15 * t:.3f},{y:.4f},{c:.5f},15,0,0\n" for t, y, c in zip(time, lateral, course, strict=True))
    with pytest.raises(CosimError, match="it seems to be in degrees, give radians"):
        checked(HEADER + "".join(rows), tmp_path)


def test_trajectories_that_agree(tmp_path: Path) -> None:
    """Whole turns apart, noisy, on a circle, standing: nothing to say."""
    checked(line(turned=4 * math.pi), tmp_path)
    checked(line(speed=0.0), tmp_path)
    rows, rng = [], np.random.default_rng(3)
    for k in range(1200):
        t, angle = 0.01 * k, 0.5 * 0.01 * k
        x, y = 20 * np.array([math.sin(angle), 1 - math.cos(angle)]) + rng.normal(0, 0.03, 2)
        rows.append(f"{t:.3f},{x:.4f},{y:.4f},{math.remainder(angle, math.tau):.4f},10,0,0.05\n")
    checked(HEADER + "".join(rows), tmp_path)


def test_a_lane_change_along_another_trajectory_has_no_corridor(tmp_path: Path) -> None:
    file = tmp_path / "t.csv"
    file.write_text(line(course=0.0))
    request = Request(
        load("double-lane-change"), tmp_path / "out", [("reference.trajectory_file", str(file))], stop_time=0.2
    )
    finished = run(request)
    metrics = finished.summary.metrics
    assert math.isnan(metrics["corridor_violation_max"].value) and math.isnan(metrics["final_time"].value)
    finished.draw(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").stat().st_size > 20_000
