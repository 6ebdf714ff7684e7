"""Formations whose messages are late, lost or silent for a while, and whose head brakes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cosim.model.parsing import parse_assignments
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load
from scenarios.formation.errors import follower_errors, pose

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


def drive(name: str, folder: Path, *assignments: str, status: str = "ok", seed: int = 0, **others: Any) -> Outcome:
    """The values of the metrics, and the results, of a run with that end."""
    finished = run(Request(load(name), folder, parse_assignments(assignments), seed, **others))
    assert finished.summary.status == status, finished.summary.reason
    found = {name: metric.value for name, metric in finished.summary.metrics.items()}
    print(name, seed, round(found["formation_error_rms"], 3), round(found["formation_error_max"], 3))
    return found, finished.results


def rms(values: np.ndarray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def asked(results: Results, car: int) -> np.ndarray:
    """How fast (n,) [m/s2] the speed of the car's place changes, at its follower's instants, from true states.

    The outer cars of a wide V speed up and slow down more than the head does, which weaves.
    """
    follower, e = f"car{car}.follower", follower_errors(results, car, 1)
    x, y, yaw = pose(results, car, results.instants(follower)).T
    own_to_place = results.number(follower, "hand.distance") - e.hand @ [1, 1j]
    place = x + 1j * y + np.exp(1j * yaw) * own_to_place
    speed = np.abs(np.gradient(place, e.time))
    return np.convolve(np.gradient(speed, e.time), np.ones(5) / 5, "same")


def check_commands(results: Results, cars: int, until: float) -> None:
    """Accelerations commanded up to a time: little more than those of the place, and not to and fro within half a
    second."""
    window = np.ones(25) / 25
    for k in range(2, cars + 1):
        times = results.time[results.instants(f"car{k}.follower")]
        rows = (times > 0.2) & (times < until - 0.2)
        command, place = results.samples(f"car{k}.follower", "command.acceleration")[rows], rms(asked(results, k)[rows])
        rough = (command - np.convolve(command, window, "same"))[25:-25]
        print(f"car {k}: {rms(command):.2f} m/s2, rough {rms(rough):.2f}; its place {place:.2f}")
        assert rms(command) <= 1.3 * place + 0.2
        assert rms(rough) <= 0.4


@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("radio", "most"), [((), 0.5), (BAD, 0.8)], ids=["nominal", "bad"])
def test_a_head_that_brakes_is_followed(name: str, radio: tuple[str, ...], most: float, tmp_path: Path) -> None:
    metrics, results = drive(name, tmp_path, LIGHT, *BRAKING, *radio, stop_time=14.0)
    assert results["car1.plant.velocity.x"][-1] == pytest.approx(10.0, abs=0.3)
    assert metrics["formation_error_max"] <= most
    assert metrics["collision"] == 0.0
    if not radio:
        check_commands(results, 4, 14.0)


def test_late_and_lost_messages_are_borne_by_learning_followers(tmp_path: Path) -> None:
    metrics, _ = drive("formation-adaptive", tmp_path, LIGHT, *BAD, stop_time=20.0)
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
@pytest.mark.parametrize("size", [4, 25])
def test_commands_of_the_whole_manoeuvre_stay_drivable(name: str, size: int, tmp_path: Path) -> None:
    """In a V, whose outer places accelerate most."""
    _, results = drive(name, tmp_path, LIGHT, f"scenario.vehicles={size}", "scenario.topology=v")
    check_commands(results, size, float(results.time[-1]))


SILENT = ("car*.radio.outage.start=8", "car*.radio.outage.duration=3")
"""No follower hears the head for 3 s, in the middle of a bend."""
FORCE, PUSHED_AT = -6000.0, 9.0
"""[N] for 1 s from that time [s] on, at a car in the middle."""


def check_it_is_survived(name: str, folder: Path, size: int, *assignments: str, **others: Any) -> None:
    """A silence of the head and, while it lasts, a push: all are lost, nobody is hit, and all find back.

    They drive straight on through the bend, so they lose their places by more than the scenario allows meanwhile.
    """
    pushed = size // 2 + 1
    force = f"car{pushed}.plant.body_force.x"
    push = [(PUSHED_AT, force, str(FORCE)), (PUSHED_AT + 1.0, force, "0")]
    cars = (f"scenario.vehicles={size}", *SILENT, *assignments)
    metrics, results = drive(name, folder, *cars, status="missed", events=push, **others)
    assert min(results[f"car{k}.follower.link.lost"].max() for k in range(2, size + 1)) == 1.0
    lost = (results.time > PUSHED_AT) & (results.time < PUSHED_AT + 1.5)
    braked = np.gradient(results[f"car{pushed}.plant.velocity.x"], results.time)[lost].min()
    assert braked < -1.0
    assert metrics["collision"] == 0.0
    late = results.time > results.time[-1] - 1.0
    for k in range(2, size + 1):
        assert np.hypot(*(results[f"car{k}.follower.error.{axis}"][late] for axis in "xy")).max() < 0.5


@pytest.mark.parametrize("name", LAWS)
def test_a_silence_of_the_head_and_a_push_end_without_a_collision(name: str, tmp_path: Path) -> None:
    check_it_is_survived(name, tmp_path, 5, LIGHT, stop_time=24.0)


@pytest.mark.nightly
@pytest.mark.parametrize("name", LAWS)
@pytest.mark.parametrize(("plant", "size"), [("unicycle", 13), ("16dof", 5)])
def test_larger_and_heavier_formations_survive_them_too(name: str, plant: str, size: int, tmp_path: Path) -> None:
    check_it_is_survived(name, tmp_path, size, f"scenario.plant={plant}", stop_time=24.0)
