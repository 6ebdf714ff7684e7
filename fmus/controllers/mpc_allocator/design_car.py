"""The car as the controller assumes it: the double-track equations with the numbers of the parameters `design.*`."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from fmukit.kernel import Signals
from fmus.cars import published
from fmus.cars.double_track import DoubleTrackCar, double_track_car
from fmus.double_track.model import motion
from fmus.single_track.forces import air_drag, planar_motion, rolling_coefficient

INPUTS = ("steer", "left", "right")
"""Steering angle asked for [rad], force of both left and of both right wheels [N]."""
SLOWEST = 3.0
"""Speed [m/s] below which slip angles and sideslip move as at this speed: at rest their equations are singular."""

STANDSTILL = 1.0
"""Speed [m/s] below which the direction of motion means nothing, and the car is led to rest."""


def design_car(parameters: Signals) -> DoubleTrackCar:
    """The car of the parameters `design.*`: its numbers are symbols."""
    names = [variable.name for variable in published.double_track_parameters()]
    return double_track_car({name: parameters[f"design.{name}"] for name in names})


def rate(car: DoubleTrackCar, lag: ca.SX, x: ca.SX, u: ca.SX, a: ca.SX) -> ca.SX:
    """x' (7) of the states of the double-track car under u = (delta_c, F_L, F_R); a (2) is behind the wheel loads.

    F_x = F_L + F_R and M_z = d (F_R - F_L) act whatever the steering angle; half of F_x is at the front wheels and
    turns with them. delta' = (delta_c - delta)/lag. Rolling resistance and air fade out below STANDSTILL.
    """
    v = ca.fmax(x[2], SLOWEST)
    moving = ca.vertcat(x[:2], v, x[3:])
    omega_delta = (u[0] - x[6]) / lag
    coasting = motion(car, moving, ca.vertcat(omega_delta, 0, 0, 0, 0), a)
    p, drive = car.planar, u[1] + u[2]
    F_x, F_y = ca.vertsplit(p.m * coasting.acceleration)
    M_z = p.I_zz * coasting.x_dot[5]
    at_rest = 1 - ca.fmin(ca.fmax(x[2] / STANDSTILL, 0), 1)
    F_x += at_rest * (rolling_coefficient(p, v) * p.m * p.g + air_drag(p, v))
    load = (F_x + drive, F_y + 0.5 * ca.sin(x[6]) * drive, M_z + car.d * (u[2] - u[1]))
    x_dot = planar_motion(p, moving, omega_delta, load)
    return ca.vertcat(x[2] / v * x_dot[:2], x_dot[2:])


def wheel_rate(car: DoubleTrackCar, x: ca.SX, U: ca.SX, a: ca.SX) -> tuple[ca.SX, ca.SX]:
    """x' (7) with delta' = 0 and the body accelerations (2) under the four wheel forces U [N]."""
    v = ca.fmax(x[2], SLOWEST)
    found = motion(car, ca.vertcat(x[:2], v, x[3:]), ca.vertcat(0, U), a)
    return ca.vertcat(x[2] / v * found.x_dot[:2], found.x_dot[2:]), found.acceleration


def steered(delta: ca.SX, command: ca.SX, lag: ca.SX, time: ca.SX | float) -> ca.SX:
    """delta [rad] a time after the command was given: the lag's exact answer."""
    return command + (delta - command) * ca.exp(-time / lag)


Rate = Callable[[ca.SX, float], ca.SX]


def advance(f: Rate, x: ca.SX, command: ca.SX, lag: ca.SX, h: ca.SX | float) -> ca.SX:
    """x (7) after h [s] of x' = f(x, part of h gone), by the classical Runge-Kutta method; delta by its lag, exactly.

    However short the lag, the step stays stable.
    """

    def at(state: ca.SX, part: float) -> ca.SX:
        return f(ca.vertcat(state[:6], steered(x[6], command, lag, part * h)), part)

    k1 = at(x, 0)
    k2 = at(x + h / 2 * k1, 0.5)
    k3 = at(x + h / 2 * k2, 0.5)
    k4 = at(x + h * k3, 1)
    after = x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return ca.vertcat(after[:6], steered(x[6], command, lag, h))
