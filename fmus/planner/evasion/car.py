"""The car that evades: single-track with combined slip, on a road of any friction."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import casadi as ca
import numpy as np

from fmus.cars.grip import with_grip
from fmus.cars.single_track import SingleTrackCar
from fmus.planner.gates import Array
from fmus.planner.vehicle import Vehicle, two_wheel_drive
from fmus.single_track import model
from fmus.single_track.forces import STATES

Means = Literal["steer", "brake", "drive", "full brakes"]
"""With what the car evades, besides steering: wheels rolling free; brakes; motors as well; all the brakes have."""

SIDESLIP = 0.12
"""Largest sideslip [rad] of a manoeuvre (engineering choice: a controller has to follow it)."""
FRONT, REAR, STEERING_RATE = (-6e3, 0.0), (-4e3, 5e3), 0.5
"""Axle forces at friction 1 [N] and steering rate [rad/s]: engineering choices, 92 % and 71 % of the axles' grip."""


def motion(car: SingleTrackCar) -> ca.Function:
    """f(x, u, mu) -> x': on friction mu the peaks are mu D, the factors B/mu, the grip mu F_z."""
    x, u, mu = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(model.INPUTS)), ca.SX.sym("mu")
    x_dot = model.derivative(with_grip(car, mu), x, u, mu)
    return ca.Function("evading", [x, u, mu], [ca.cse(x_dot)], ["x", "u", "mu"], ["x_dot"])


def input_limits(mu: float, means: Means) -> tuple[Array, Array]:
    """Least and largest (omega_delta, U_F, U_R); the forces are in proportion to the friction."""
    low, high = np.array([-STEERING_RATE, FRONT[0], REAR[0]]), np.array([STEERING_RATE, FRONT[1], REAR[1]])
    brakes, motors = mu * (means != "steer"), mu * (means == "drive")
    least, most = np.array([1, brakes, brakes]) * low, np.array([1, motors, motors]) * high
    if means == "full brakes":
        most[1:] = least[1:]
    return least, most


def evading_car(car: SingleTrackCar, mu: float, means: Means, slowest: float = 0.0) -> Vehicle:
    """The car for the planner, on friction `mu`, never slower than `slowest` [m/s]."""
    vehicle = two_wheel_drive(with_grip(car, mu), friction=mu)
    (low, high), lower, upper = input_limits(mu, means), vehicle.lower.copy(), vehicle.upper.copy()
    lower[2], lower[3], upper[3] = max(lower[2], slowest), -SIDESLIP, SIDESLIP
    idle = np.clip(np.zeros(3), low, high)
    return replace(vehicle, lower=lower, upper=upper, input_lower=low, input_upper=high, idle=idle)
