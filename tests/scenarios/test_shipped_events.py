"""The files of events that come along: each does what it says to the systems it is for."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.model.parsing import parse_assignments
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load
from cosim.system_file.events import offered

PAIR = ("scenario.plant=unicycle", "scenario.vehicles=2")


def ran(name: str, events: str, folder: Path, stop: float, *assignments: str) -> Results:
    request = Request(load(name), folder, parse_assignments(assignments), stop_time=stop, event_files=[events])
    finished = run(request)
    assert finished.summary.status in ("ok", "missed"), finished.summary.reason  # part of a manoeuvre
    return finished.results


def test_every_file_has_a_test() -> None:
    assert set(offered()) == {
        "gps-outage", "stuck-wheel-speed", "motor-loss", "split-friction", "side-wind", "radio-loss"
    }  # fmt: skip


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory: pytest.TempPathFactory) -> Results:
    folder = tmp_path_factory.mktemp("plain")
    return run(Request(load("lateral-tracking"), folder, stop_time=8.5)).results


def test_no_fixes_for_3_s(tmp_path: Path, undisturbed: Results) -> None:
    """The estimate's own deviation grows while there is none, and falls again with the first."""
    results = ran("lateral-tracking", "gps-outage", tmp_path, 8.5)
    name = "filter.std.position.x"
    at = lambda values, time: values[np.searchsorted(results.time, time)]  # noqa: E731
    grown, usual = results[name], undisturbed[name]
    assert at(grown, 4.9) == at(usual, 4.9)
    assert at(grown, 7.95) > 2 * at(usual, 7.95)
    assert at(grown, 8.45) < 0.7 * at(grown, 7.95)


def test_a_gust(tmp_path: Path) -> None:
    results = ran("lateral-tracking", "side-wind", tmp_path, 7.5)
    force = results["plant.body_force.y"]
    expected = np.where(
        (results.time >= 5 - 1e-9) & (results.time < 7 - 1e-9), np.clip((results.time - 5) / 0.5, 0, 1) * 2000.0, 0.0
    )
    np.testing.assert_allclose(force[:-1], expected[:-1], atol=1e-6)


def test_a_stuck_wheel_speed(tmp_path: Path) -> None:
    results = ran("longitudinal-tracking", "stuck-wheel-speed", tmp_path, 5.0)
    after = results.time >= 4.0
    taken, true = results["llc.wheel_speed.fl"], results["plant.wheel_speed.fl"]
    assert np.ptp(taken[after]) == 0.0 and np.ptp(true[after]) > 0.5
    np.testing.assert_array_equal(taken[~after][1:], true[~after][1:])


def test_ice_on_the_left(tmp_path: Path) -> None:
    results = ran("longitudinal-tracking", "split-friction", tmp_path, 6.2)
    late = results.time >= 6.0
    assert (results["plant.road_friction.fl"][late] == 0.3).all()
    assert (results["plant.road_friction.fl"][~late] == 1.0).all()


def test_a_lost_motor(tmp_path: Path) -> None:
    results = ran("double-lane-change-16dof", "motor-loss", tmp_path, 2.5)
    after = results.time >= 2.0
    assert (results["plant.wheel_torque.rr"][after] == 0.0).all()


def test_nothing_is_heard_for_3_s(tmp_path: Path) -> None:
    results = ran("formation-adaptive", "radio-loss", tmp_path, 8.5, *PAIR)
    age = results["car2.radio.leader.age"]
    assert age[results.time < 5.0].max() < 0.5 and 2.8 < age.max() < 3.3
