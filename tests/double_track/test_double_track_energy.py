"""The planar car makes no energy: over random drives, by what its outputs tell."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fmukit.direct import Direct
from fmus.cars.wheels import WHEELS
from fmus.double_track import COMPONENT

H, STEPS = 1e-3, 4000


def wave(rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return rng.uniform(0.1, 0.8, 4), rng.normal(size=4) / 2.0, rng.uniform(0, math.tau, 4)


def at(signal: tuple[np.ndarray, np.ndarray, np.ndarray], t: float) -> float:
    frequency, size, phase = signal
    return float(size @ np.sin(math.tau * frequency * t + phase))


def flows(car: Direct, u: dict[str, float]) -> tuple[float, np.ndarray]:
    """Power into the car [W], and what is lost: by each wheel rolling (4), by each sliding (4), to the air."""
    p = dict(zip(car.interface.names("parameter"), car.p, strict=True))
    l_F, l_R, d = (p[f"geometry.{name}"] for name in ("front_axle", "rear_axle", "half_track"))
    places = {"fl": (l_F, d), "fr": (l_F, -d), "rl": (-l_R, d), "rr": (-l_R, -d)}
    v_x, v_y, r = car["velocity.x"], car["velocity.y"], car["angular_rate.z"]
    driving, rolling, sliding = 0.0, [], []
    for wheel, (X, Y) in places.items():
        delta = car["steer_angle.fl"] if wheel.startswith("f") else 0.0
        along, across = v_x - r * Y, v_y + r * X
        V_x, V_y = (
            along * math.cos(delta) + across * math.sin(delta),
            across * math.cos(delta) - along * math.sin(delta),
        )
        motor = u.get(f"wheel_torque.{wheel}", 0.0) * car[f"wheel_speed.{wheel}"]
        driving += motor
        rolling.append(motor - car[f"tyre_force_x.{wheel}"] * V_x)
        sliding.append(-car[f"tyre_force_y.{wheel}"] * V_y)
    speed2 = v_x**2 + v_y**2
    air = 0.5 * p["air.density"] * p["body.drag_coefficient"] * p["body.frontal_area"] * speed2
    external = u["body_force.y"] * v_y + u["body_moment.z"] * r
    drag = air * v_x * min(max(v_x / p["low_speed.speed"], -1.0), 1.0)
    return driving + external, np.array([*rolling, *sliding, drag])


def kinetic(car: Direct) -> float:
    p = dict(zip(car.interface.names("parameter"), car.p, strict=True))
    v2 = car["velocity.x"] ** 2 + car["velocity.y"] ** 2
    return 0.5 * (p["body.mass"] * v2 + p["body.inertia.z"] * car["angular_rate.z"] ** 2)


def refresh(car: Direct) -> None:
    car.y = car.kernel.output(car.p, car.d, car.u, car.x).full().ravel()  # type: ignore[union-attr, misc]


@pytest.mark.parametrize("combined", [True, False])
@pytest.mark.parametrize("speed", [20.0, 4.0])
def test_what_comes_in_is_kept_or_lost(combined: bool, speed: float) -> None:
    """Closed to 1e-5 of what is turned over, and nothing that loses gives more than it had taken.

    But for 0.5 J of a wheel: in stopping the car friction acts against its reversal, not against its motion.
    """
    rng = np.random.default_rng(int(speed) + combined)
    car = Direct(COMPONENT, {"initial.speed": speed, "tyre.combined_slip": combined})
    signals = {name: wave(rng) for name in (*WHEELS, *(f"b{w}" for w in WHEELS), "steer", "force", "moment")}
    began, came, lost, least = kinetic(car), 0.0, np.zeros(9), np.zeros(9)
    for k in range(STEPS):
        t = (k + 0.5) * H
        u = {
            **{f"wheel_torque.{w}": 300.0 * (at(signals[w], t) + 0.5) for w in WHEELS},
            **{f"brake_torque.{w}": max(1000.0 * at(signals[f"b{w}"], t), 0.0) for w in WHEELS},
            "command.steer_angle": 0.05 * at(signals["steer"], t),
            "body_force.y": 500.0 * at(signals["force"], t),
            "body_moment.z": 300.0 * at(signals["moment"], t),
        }
        car.set(u)
        refresh(car)
        first = flows(car, u)
        car.advance(H)
        last = flows(car, u)
        came += H / 2 * (first[0] + last[0])
        lost += H / 2 * (first[1] + last[1])
        least = np.minimum(least, lost)
    assert came - lost.sum() == pytest.approx(kinetic(car) - began, abs=1e-5 * lost.sum())
    assert least.min() > -0.5
