"""The double-track car derived from the multibody car drives like it, and either plant takes the other's place."""

from __future__ import annotations

import pytest

from fmukit.direct import Direct
from fmus import double_track, vehicle16dof
from fmus.cars.derived import double_track_values
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import FRONT, WHEELS

BOTH = {"roll", "pitch", "yaw", "sideslip", "fault"}


def test_shared_ports_are_the_same() -> None:
    ours = {v.name: v for v in double_track.INTERFACE.variables}
    theirs = {v.name: v for v in vehicle16dof.INTERFACE.variables if v.causality != "parameter"}
    shared = ours.keys() & theirs.keys()
    assert len(shared) > 60 and shared >= BOTH
    for name in shared:
        for fact in ("causality", "unit", "minimum", "maximum", "start", "type"):
            assert getattr(ours[name], fact) == getattr(theirs[name], fact), (name, fact)
    assert {v.name for v in double_track.INTERFACE.select("output")} <= theirs.keys()


def test_parameters_are_within_limits_and_derived() -> None:
    limits = {v.name: v for v in double_track.INTERFACE.select("parameter")}
    found = double_track_values(DESIGN)
    for name, value in found.items():
        assert limits[name].minimum <= value <= limits[name].maximum, name
    assert found["body.mass"] == 1500.0
    assert found["body.drag_coefficient"] * found["body.frontal_area"] == pytest.approx(0.63)
    own = limits.keys() - found.keys()
    assert {name.split(".")[0] for name in own} == {"load", "steering", "low_speed", "initial", "tyre"}
    assert {name for name in own if name.startswith("tyre")} == {
        *("tyre.friction", "tyre.combined_slip", "tyre.slip_stiffness", "tyre.slip_lag")
    }


@pytest.mark.parametrize("speed", [15.0, 25.0])
def test_steady_yaw_rate_is_that_of_the_multibody_car(speed: float) -> None:
    """Both coast at the same steering angle, at about 0.7 m/s2: the planar car follows what the kingpins turn."""
    delta = 0.7 / speed**2 * (DESIGN.wheelbase + 1.3e-3 * speed**2)
    heavy = Direct(vehicle16dof.COMPONENT, {"initial.speed": speed})
    light = Direct(double_track.COMPONENT, {**double_track_values(DESIGN), "initial.speed": speed})
    for _ in range(1500):
        angles = {w: heavy[f"steer_angle.{w}"] for w in FRONT}
        rates = {w: heavy[f"steer_rate.{w}"] for w in FRONT}
        heavy.set({f"steer_torque.{w}": 40000.0 * (delta - angles[w]) - 200.0 * rates[w] for w in FRONT})
        light.set({"command.steer_angle": sum(angles.values()) / 2})
        heavy.advance(0.002)
        light.advance(0.002)
    assert light["angular_rate.z"] == pytest.approx(heavy["angular_rate.z"], rel=0.05)
    assert light["velocity.x"] == pytest.approx(heavy["velocity.x"], rel=0.01)
    assert 0.4 < light["acceleration.y"] < 1.0


def test_same_torques_accelerate_alike() -> None:
    torque = {f"wheel_torque.{w}": 200.0 for w in WHEELS}
    heavy = Direct(vehicle16dof.COMPONENT, {"initial.speed": 15.0}, torque)
    light = Direct(double_track.COMPONENT, {**double_track_values(DESIGN), "initial.speed": 15.0}, torque)
    for plant in (heavy, light):
        for _ in range(100):
            plant.advance(0.02)
    # the planar car has no wheels to spin up, 3 % of the mass
    assert light["velocity.x"] - 15.0 == pytest.approx(heavy["velocity.x"] - 15.0, rel=0.05)
    assert light["velocity.x"] > heavy["velocity.x"]
