"""The car that evades: single-track with combined slip, on a road of any friction."""

from __future__ import annotations

from dataclasses import replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from fmus.planner.gates import Array
from fmus.planner.vehicle import Vehicle, two_wheel_drive
from fmus.single_track import model
from fmus.single_track.data import Car, Tyre
from fmus.single_track.forces import STATES

Means = Literal["steer", "brake", "drive", "full brakes"]
"""With what the car evades, besides steering: wheels rolling free; brakes; motors as well; all the brakes have."""

SIDESLIP = 0.12
"""Largest sideslip [rad] of a manoeuvre (engineering choice: a controller has to follow it)."""
FRONT, REAR, STEERING_RATE = (-6e3, 0.0), (-4e3, 5e3), 0.5
"""Axle forces at friction 1 [N] and steering rate [rad/s]: engineering choices, 92 % and 71 % of the axles' grip."""


def motion(car: Car) -> ca.Function:
    """f(x, w) -> x', w = (omega_delta, U_F, U_R, mu): on friction mu peaks are mu D, factors B/mu, grip mu F_z."""
    x, w = ca.SX.sym("x", len(STATES)), ca.SX.sym("w", len(model.INPUTS) + 1)
    x_dot = model.derivative(on_road(car, w[3]), x, w[:3], w[3])
    return ca.Function("evading", [x, w], [ca.cse(x_dot)], ["x", "w"], ["x_dot"])


def on_road(car: Car, mu: Any) -> Car:
    """The car on friction `mu`, a number or a symbol; the slip stiffness keeps."""
    return replace(car, front=_on_road(car.front, mu), rear=_on_road(car.rear, mu))


def input_limits(mu: float, means: Means) -> tuple[Array, Array]:
    """Least and largest (omega_delta, U_F, U_R); the forces are in proportion to the friction."""
    low, high = np.array([-STEERING_RATE, FRONT[0], REAR[0]]), np.array([STEERING_RATE, FRONT[1], REAR[1]])
    brakes, motors = mu * (means != "steer"), mu * (means == "drive")
    least, most = np.array([1, brakes, brakes]) * low, np.array([1, motors, motors]) * high
    if means == "full brakes":
        most[1:] = least[1:]
    return least, most


def evading_car(car: Car, mu: float, means: Means, slowest: float = 0.0) -> Vehicle:
    """The car for the planner, on friction `mu`, never slower than `slowest` [m/s]."""
    vehicle = two_wheel_drive(on_road(car, mu), friction=mu)
    (low, high), lower, upper = input_limits(mu, means), vehicle.lower.copy(), vehicle.upper.copy()
    lower[2], lower[3], upper[3] = max(lower[2], slowest), -SIDESLIP, SIDESLIP
    idle = np.clip(np.zeros(3), low, high)
    return replace(vehicle, lower=lower, upper=upper, input_lower=low, input_upper=high, idle=idle)


def _on_road(tyre: Tyre, mu: Any) -> Tyre:
    return replace(tyre, B=tyre.B / mu, D=tyre.D * mu)
