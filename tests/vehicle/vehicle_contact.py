"""Coordinates, contacts and tyre wrenches of a test car in the world, from its state and outputs alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from vehicle_car import SLICES, Car

from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import CORNERS


def named(car: Car) -> dict[str, float]:
    return dict(zip(INTERFACE.names("parameter"), car.p, strict=True))


def joint_order(per_wheel: np.ndarray, front: np.ndarray, spin: np.ndarray) -> np.ndarray:
    """Travel, steer, wheel of each corner in the order of the tree."""
    rows = []
    for c in CORNERS:
        rows += (
            [per_wheel[c.index], front[c.index], spin[c.index]] if c.steered else [per_wheel[c.index], spin[c.index]]
        )
    return np.array(rows)


def coordinates(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(q, u) of Pinocchio from the state column."""
    s = {name: x[where] for name, where in SLICES.items()}
    w, *vector = s["attitude"]
    q = joint_order(s["travel"], s["steer"], s["wheel_angle"])
    u = joint_order(s["travel_rate"], s["steer_rate"], s["wheel_speed"])
    return np.concatenate([s["position"], vector, [w], q]), np.concatenate([s["velocity"], s["angular_rate"], u])


@dataclass(frozen=True)
class Touch:
    """Where a wheel touches the road z = 0: directions of the track and of the axle, arm from the wheel centre."""

    x: np.ndarray
    y: np.ndarray
    axle: np.ndarray
    arm: np.ndarray


UP = np.array([0.0, 0.0, 1.0])


def road_contact(centre: np.ndarray, axle: np.ndarray) -> Touch:
    """The lowest point of the disc, prolonged to the road."""
    x = np.cross(axle, UP)
    x /= np.linalg.norm(x)
    down = np.cross(axle, x)
    down *= -np.sign(down[2])
    return Touch(x, np.cross(UP, x), axle, down * (centre[2] / -down[2]))


def tyre_wrench(
    car: Car, wheel: str, touch: Touch, velocity: np.ndarray, turning: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Force at the contact point and free moment on the wheel, in the world, from the car's outputs.

    Aligning moment -t F_y about the upright of the wheel, t falling with load and slip; rolling resistance
    f_r F_z R_e against the spin; F_x (R_e - r), by which the longitudinal force has the arm R_e. `velocity` is that of
    the wheel's centre, `turning` the angular velocity of the wheel.
    """
    p = named(car)
    F_x, F_y, F_z = (car[f"tyre_force_{a}.{wheel}"] for a in "xyz")
    r = float(np.linalg.norm(touch.arm))
    trail = p["tyre.trail"] * F_z / p["tyre.nominal_load"]
    trail *= max(0.0, 1.0 - abs(np.tan(car[f"slip_angle.{wheel}"])) / p["tyre.trail_vanishing_slip"])
    v = abs(velocity @ touch.x)
    f_r = p["tyre.rolling.constant"] + p["tyre.rolling.linear"] * v + p["tyre.rolling.quartic"] * v**4
    R_e = p["wheel.radius"] - (p["wheel.radius"] - r) / 3.0
    rolling = f_r * F_z * R_e * np.tanh(turning @ touch.axle / p["tyre.rolling.fade"])
    moment = trail * F_y * touch.arm / r - (rolling + F_x * (R_e - r)) * touch.axle
    return F_x * touch.x + F_y * touch.y + F_z * UP, moment
