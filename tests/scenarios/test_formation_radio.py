"""Formations whose messages are late, lost or silent for a while, and whose head brakes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.model.system import parse_assignments
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

LAWS = ("formation-adaptive", "formation-constraint")
LIGHT = "scenario.plant=unicycle"
BAD = ("car*.radio.loss.probability=0.3", "car*.radio.latency=0.1")
"""Every third message lost, and all 100 ms late."""
BRAKING = tuple(
    f"car1.reference.{name}"
    for name in (
        *("initial_speed=25", "acceleration=0", "amplitude=0", "deceleration=3"),
        *("deceleration.start=4", "deceleration.end=9.5"),
    )
)
"""The head brakes from 25 to 10 m/s, with 3 m/s2."""
Outcome = tuple[dict[str, float], Results]


def drive(
    name: str, folder: Path, *assignments: str, stop: float | None = None, seed: int = 0, status: str = "ok"
) -> Outcome:
    """The values of the metrics, and the results, of a run with that end."""
    finished = run(Request(load(name), folder, parse_assignments(assignments), seed, stop))
    assert finished.summary.status == status, finished.summary.reason
    found = {name: metric.value for name, metric in finished.summary.metrics.items()}
    print(name, seed, round(found["formation_error_rms"], 3), round(found["formation_error_max"], 3))
    return found, finished.results


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def check_commands(results: Results, cars: int, until: float) -> None:
    """Accelerations commanded up to a time: little more than the head's, and not to and fro within half a second."""
    rows = results.time < until
    head = rms(np.gradient(results["car1.plant.velocity.x"], results.time)[rows])
    window = np.ones(25) / 25
    for k in range(2, cars + 1):
        command = results[f"car{k}.follower.command.acceleration"][rows]
        rough = (command - np.convolve(command, window, "same"))[25:-25]
        print(f"car {k}: {rms(command):.2f} m/s2, rough {rms(rough):.2f}; head {head:.2f}")
        assert rms(command) <= 1.3 * head + 0.2
        assert rms(rough) <= 0.4


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("radio", "most"), [((), 0.5), (BAD, 0.8)], ids=["nominal", "bad"])
def test_a_head_that_brakes_is_followed(name: str, radio: tuple[str, ...], most: float, tmp_path: Path) -> None:
    metrics, results = drive(name, tmp_path, LIGHT, *BRAKING, *radio, stop=14.0)
    assert results["car1.plant.velocity.x"][-1] == pytest.approx(10.0, abs=0.3)
    assert metrics["formation_error_max"] <= most
    assert metrics["collision"] == 0.0
    if not radio:
        check_commands(results, 4, 14.0)


def test_late_and_lost_messages_are_borne_by_learning_followers(tmp_path: Path) -> None:
    metrics, _ = drive("formation-adaptive", tmp_path, LIGHT, *BAD, stop=20.0)
    assert metrics["formation_error_rms"] <= 0.25


@pytest.mark.nightly
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize("seed", [0, 1, 2])
def test_late_and_lost_messages_are_borne_in_the_whole_manoeuvre(name: str, seed: int, tmp_path: Path) -> None:
    metrics, _ = drive(name, tmp_path, LIGHT, *BAD, seed=seed)
    assert metrics["formation_error_rms"] <= 0.25
    assert metrics["collision"] == 0.0


@pytest.mark.nightly
@pytest.mark.parametrize("name", LAWS)
def test_commands_of_the_whole_manoeuvre_stay_drivable(name: str, tmp_path: Path) -> None:
    _, results = drive(name, tmp_path, LIGHT)
    check_commands(results, 4, float(results.time[-1]))


@pytest.mark.nightly
@pytest.mark.parametrize("name", LAWS)
def test_a_silence_of_the_head_ends_without_a_collision(name: str, tmp_path: Path) -> None:
    """Of 3 s in the middle of a bend: all drive straight on, and are metres off until they have caught up."""
    silent = ("car*.radio.outage.start=8", "car*.radio.outage.duration=3")
    metrics, results = drive(name, tmp_path, LIGHT, "scenario.vehicles=13", *silent, stop=24.0)
    assert max(results[f"car{k}.follower.link.lost"].max() for k in range(2, 14)) == 1.0
    assert metrics["collision"] == 0.0
