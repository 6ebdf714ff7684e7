"""LowLevelPid on a driven car: anti-lock, traction, unequal brakes, limits of the motors.

The ideal of a stop is that of the largest force of the tyre's formula at nominal load.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from low_level_drive import Drive, Script

from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.vehicle16dof import magic

LEFT, RIGHT = ("fl", "rl"), ("fr", "rr")
START = 0.5
"""When [s] braking begins."""
PASSIVE = {"slip.enabled": False, "motor.power": 1e6, "motor.speed": 1000.0}
"""Nothing limits slip or motors."""
Rows = dict[str, np.ndarray]


def road(left: float, right: float | None = None) -> dict[str, float]:
    other = left if right is None else right
    return {f"road_friction.{w}": left if w in LEFT else other for w in WHEELS}


def slowing(speed: float, deceleration: float, friction: Mapping[str, float]) -> Script:
    """Commands of a stop straight ahead, from START on."""

    def script(t: float, _: Drive) -> dict[str, float]:
        braking = t >= START
        return {
            "command.acceleration": -deceleration if braking else 0.0,
            "command.speed": max(speed - deceleration * max(t - START, 0.0), 0.0),
            **friction,
        }

    return script


def slower_than(speed: float) -> Callable[[Drive], bool]:
    return lambda drive: drive.car["velocity.x"] < speed


def stop(
    speed: float, deceleration: float, friction: Mapping[str, float], controller: Mapping[str, float] | None = None
) -> Rows:
    drive = Drive({"initial.speed": speed}, controller)
    return drive.run(30.0, slowing(speed, deceleration, friction), slower_than(0.1))


def distance(rows: Rows) -> float:
    return float(rows["position.x"][-1] - np.interp(START, rows["time"], rows["position.x"]))


def ideal_distance(speed: float, friction: float) -> float:
    """v^2/(2 a) with the largest force of the tyres [m]."""
    slips = np.linspace(0.0, 0.3, 1000)
    load = DESIGN.tyre["nominal_load"]
    largest = max(magic.longitudinal(math, DESIGN.tyre, load, friction, float(s)) for s in slips) / load
    return speed**2 / (2.0 * largest * DESIGN.gravity)


def heading(rows: Rows) -> float:
    """Largest [degrees]."""
    return math.degrees(np.abs(rows["yaw"]).max())


def fastest_slip(rows: Rows, above: float = 5.0) -> float:
    """Largest |slip| of any wheel at speeds above one [m/s]."""
    fast = rows["velocity.x"] > above
    return max(float(np.abs(rows[f"slip_ratio.{w}"][fast]).max()) for w in WHEELS)


def test_split_friction_stop_keeps_heading_and_path() -> None:
    rows = stop(25.0, 5.0, road(0.3, 1.0))
    assert heading(rows) < 1.5
    assert np.abs(rows["position.y"]).max() < 0.1
    assert distance(rows) < 0.8 * ideal_distance(25.0, 0.3)
    assert heading(stop(25.0, 5.0, road(0.3, 1.0), PASSIVE)) > 15.0


@pytest.mark.nightly
@pytest.mark.parametrize(
    ("friction", "speed", "deceleration"), [(road(1.0, 0.3), 33.0, 7.0), (road(0.2, 0.8), 15.0, 5.0)]
)
def test_split_friction_on_other_roads(friction: dict[str, float], speed: float, deceleration: float) -> None:
    rows = stop(speed, deceleration, friction)
    assert heading(rows) < 3.0
    assert np.abs(rows["position.y"]).max() < 0.3


@pytest.mark.parametrize(
    ("friction", "speed"),
    [
        (0.3, 25.0),
        pytest.param(0.15, 15.0, marks=pytest.mark.nightly),
        pytest.param(0.4, 35.0, marks=pytest.mark.nightly),
    ],
)
def test_stop_on_a_slippery_road(friction: float, speed: float) -> None:
    rows = stop(speed, 8.0, road(friction))
    assert distance(rows) < 1.15 * ideal_distance(speed, friction)
    assert fastest_slip(rows) < 0.12


@pytest.mark.parametrize(("speed", "a", "a_y"), [(25.0, 4.0, 4.4), (25.0, 6.0, 4.4)])
def test_braking_in_a_turn(speed: float, a: float, a_y: float) -> None:
    """Steering held: no wheel locks, and the yaw rate a second later is at most 1.3 times that before."""
    ratio, slowest = braked_turn(speed, a, a_y)
    assert ratio < 1.3
    assert slowest > 0.8


@pytest.mark.nightly
@pytest.mark.parametrize(("speed", "a", "a_y"), [(30.0, 6.0, 4.4), (20.0, 5.0, 5.0)])
def test_braking_in_other_turns(speed: float, a: float, a_y: float) -> None:
    ratio, slowest = braked_turn(speed, a, a_y)
    assert ratio < 1.3
    assert slowest > 0.8


def braked_turn(speed: float, deceleration: float, a_y: float) -> tuple[float, float]:
    """Yaw rate a second after braking begins over that before, and the slowest wheel's speed over the car's."""
    drive = Drive({"initial.speed": speed}, {"yaw.enabled": False})
    steer = 0.0

    def steady(t: float, car: Drive) -> dict[str, float]:
        nonlocal steer
        steer += 1e-2 * 0.02 * (min(t / 2.0, 1.0) * a_y - car.car["acceleration.y"])
        return {"command.speed": speed, "command.steer_feedforward": steer}

    drive.run(6.0, steady)
    began = drive.car["angular_rate.z"]
    assert drive.car["acceleration.y"] == pytest.approx(a_y, rel=0.03)
    rows = drive.run(
        1.0,
        lambda t, _: {"command.speed": speed - deceleration * (t - 6.0), "command.acceleration": -deceleration},
    )
    rolling = [rows[f"wheel_speed.{w}"] * DESIGN.rolling_radius / rows["velocity.x"] for w in WHEELS]
    return float(rows["angular_rate.z"][-1] / began), float(np.min(rolling))


def dwelling(t: float, amplitude: float, frequency: float = 0.7, dwell: float = 0.5) -> float:
    """Steering of the sine with dwell [rad] (FMVSS 126): a sine that waits at its second peak."""
    second_peak = 0.75 / frequency
    phase = t if t < second_peak else max(second_peak, t - dwell)
    return amplitude * math.sin(math.tau * frequency * phase) if 0.0 < phase < 1.0 / frequency else 0.0


@pytest.mark.parametrize("times", [6.5, pytest.param(8.0, marks=pytest.mark.nightly)])
def test_sine_with_dwell(times: float) -> None:
    """A is the angle of 0.3 g at 80 km/h; 1 s and 1.75 s after the end at most 35 and 20 % of the largest yaw rate."""
    v, K = 80.0 / 3.6, DESIGN.mass / DESIGN.wheelbase
    K *= (DESIGN.l_r + DESIGN.pneumatic_trail) / DESIGN.cornering_front - (
        DESIGN.l_f - DESIGN.pneumatic_trail
    ) / DESIGN.cornering_rear
    A = 0.3 * DESIGN.gravity * (DESIGN.wheelbase / v**2 + K)
    drive = Drive({"initial.speed": v}, {"speed.enabled": False})

    def script(t: float, car: Drive) -> dict[str, float]:
        steer, speed = dwelling(t - 1.0, times * A), max(car.car["velocity.x"], 5.0)
        wanted, most = speed * steer / (DESIGN.wheelbase + K * speed**2), 0.85 * DESIGN.gravity / speed
        return {"command.steer_feedforward": steer, "command.yaw_rate": min(max(wanted, -most), most)}

    end = 1.0 + 1.0 / 0.7 + 0.5
    rows = drive.run(end + 1.8, script)
    turning = np.abs(rows["angular_rate.z"])
    later = [float(np.interp(end + after, rows["time"], turning)) / turning.max() for after in (1.0, 1.75)]
    assert later[0] < 0.35
    assert later[1] < 0.2
    assert np.interp(1.0 + 1.07, rows["time"], rows["position.y"]) > 1.83


def test_traction_on_ice() -> None:
    """Full throttle on friction 0.3: the slip is limited, and the car gains speed nearly as fast as tyres allow."""
    rows = accelerate({})
    assert fastest_slip(rows, above=8.0) < 0.12
    gained = rows["velocity.x"][-1] - 5.0
    assert gained > 0.85 * 3.0 * 5.0**2 / (2.0 * ideal_distance(5.0, 0.3))


def test_motors_keep_their_power_and_speed() -> None:
    """Without slip control wheels spin up, but not beyond the speed of their motors; the power is never exceeded."""
    rows = accelerate({"slip.enabled": False, "motor.power": 20000.0, "motor.speed": 90.0})
    for w in WHEELS:
        assert rows[f"wheel_speed.{w}"].max() == pytest.approx(90.0, rel=0.05)
        assert (rows[f"llc.wheel_torque.{w}"] * rows[f"wheel_speed.{w}"]).max() < 20200.0
    assert rows["velocity.x"].max() < 20.0


def accelerate(controller: Mapping[str, float]) -> Rows:
    drive = Drive({"initial.speed": 5.0}, controller)
    return drive.run(3.0, lambda t, _: {"command.speed": 40.0, "command.acceleration": 5.0, **road(0.3)})
