"""ConstraintFollower as FMU in systems: as head of a formation on the trajectory bus, and behind that head by radio."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.model.system import System
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.definition import Scenario, Work
from cosim.scenario.settings import Setting

SPEED, DURATION = 25.0, 6.0
TRACK = {"initial_speed": SPEED, "acceleration.start": 0.5, "weave.start": 1.0, "amplitude": 3.0}
HEAD = {"constraint.offset": False, "constraint.trajectory": True, "leader.valid": 0.0}
PROMPT = {"speed.lag": 0.0, "yaw_rate.lag": 0.0}
EXACT = {"loss.probability": 0.0} | {f"{name}.noise": 0.0 for name in ("position", "yaw", "velocity", "yaw_rate")}
SELF = {"estimate.": "", "estimate.yaw_rate": "angular_rate.z"}


def _unicycles() -> System:
    system = System()
    system.add("car1.reference", "ReferenceTrajectory", TRACK)
    system.add("car1.follower", "ConstraintFollower", HEAD)
    system.add("car1.plant", "Unicycle", {"initial.speed": SPEED, **PROMPT}, 0.01)
    system.add("car2.radio", "Radio", EXACT)
    system.add("car2.follower", "ConstraintFollower", {"formation.x": -12.0, "formation.duration": 4.0})
    system.add("car2.plant", "Unicycle", {"initial.speed": SPEED, "initial.position.x": -12.0, **PROMPT}, 0.01)
    system.connect("car1.reference", "car1.follower")
    system.connect("car1.plant", "car2.radio", {"message.": "", "message.yaw_rate": "angular_rate.z"})
    system.connect("car2.radio", "car2.follower")
    for car in ("car1.", "car2."):
        system.connect(f"{car}plant", f"{car}follower", SELF)
        system.connect(f"{car}follower", f"{car}plant")
    system.at(1.0, "car2.follower.formation.x", -14.0)
    system.at(1.0, "car2.follower.formation.y", 3.5)
    return system


def _car() -> System:
    system = System()
    system.add("car1.reference", "ReferenceTrajectory", TRACK)
    system.add("car1.follower", "ConstraintFollower", {**HEAD, "lead.speed": 0.16, "lead.yaw_rate": 0.06})
    system.add("car1.llc", "LowLevelPid", {"suspension.enabled": False})
    system.add("car1.plant", "DoubleTrack", {"initial.speed": SPEED})
    system.connect("car1.reference", "car1.follower")
    system.connect("car1.follower", "car1.llc")
    system.connect("car1.plant", "car1.follower", SELF)
    system.connect("car1.plant", "car1.llc", SELF)
    for torque in ("wheel_torque", "brake_torque"):
        system.connect("car1.llc", "car1.plant", {f"{torque}.": f"{torque}."})
    system.connect("car1.llc", "car1.plant", {"command.steer_angle": "steer_demand"})
    return system


WORK = Work(build=lambda settings, _: _unicycles() if settings["drive"] == "unicycles" else _car())
SCENARIO = Scenario(
    name="constraint",
    title="a head and a follower, or a head alone",
    figures="",
    stop_time=DURATION,
    module=__name__,
    settings={"drive": Setting("unicycles", ("unicycles", "car"), "two unicycles, or one car")},
)


def _run(folder: Path, drive: str) -> Results:
    finished = run(Request(SCENARIO, folder, [("scenario.drive", drive)]))
    assert finished.summary.status == "ok", finished.summary.reason
    return finished.results


def _place(results: Results, name: str) -> np.ndarray:
    """x and y (2 x n) when the head computed: what is sampled holds in between, what moves does not."""
    rows = results.instants("car1.follower")
    return np.array([results[f"{name}.{axis}"][rows] for axis in "xy"])


def _beside(results: Results) -> np.ndarray:
    """Distance of the head's O1 from the reference [m]."""
    return np.hypot(*(_place(results, "car1.plant.position") - _place(results, "car1.reference.reference")))


@pytest.fixture(scope="module")
def unicycles(tmp_path_factory: pytest.TempPathFactory) -> Results:
    return _run(Path(tmp_path_factory.mktemp("unicycles")), "unicycles")


def test_head_of_unicycles_follows_the_trajectory_bus(unicycles: Results) -> None:
    assert np.ptp(unicycles["car1.reference.reference.y"]) > 1.0
    assert _beside(unicycles).max() < 0.06
    assert unicycles["car1.follower.link.lost"].all()


def test_follower_keeps_its_place_behind_the_radio(unicycles: Results) -> None:
    rows = unicycles.instants("car2.follower")
    hands, yaw = [], unicycles["car1.plant.yaw"][rows]
    for car in ("car1", "car2"):
        psi = unicycles[f"{car}.plant.yaw"][rows]
        hands.append(_place(unicycles, f"{car}.plant.position") + 6.0 * np.array([np.cos(psi), np.sin(psi)]))
    apart = hands[1] - hands[0]
    forward, left = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    wanted = _place(unicycles, "car2.follower.offset")
    seen = np.array([(forward * apart).sum(axis=0), (left * apart).sum(axis=0)])
    assert np.hypot(*(seen - wanted)).max() < 0.25
    assert wanted[:, -1].tolist() == [-14.0, 3.5]


def test_head_can_be_a_car_that_slides(tmp_path: Path) -> None:
    """Its law knows no sideslip: v beta' is a disturbance, answered at omega_n."""
    results = _run(tmp_path, "car")
    assert np.abs(results["car1.plant.sideslip"]).max() > 0.02
    assert _beside(results).max() < 0.75
    assert np.sqrt(np.mean(_beside(results) ** 2)) < 0.3
