"""Double-track car: wheel loads, slips and forces, and x' of the states of the single-track car."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmus.cars.double_track import DoubleTrackCar
from fmus.single_track.forces import STATES, air_drag, ellipse, lateral, planar_motion, rolling_coefficient

INPUTS = ("omega_delta", "U_FL", "U_FR", "U_RL", "U_RR")
"""Steering rate [rad/s], longitudinal force of each wheel [N], drive > 0."""


@dataclass(frozen=True, slots=True)
class Motion:
    """x' (7), body accelerations a_x, a_y [m/s2] (2), and per wheel (4): loads, F_l, F_t [N], slip angles [rad]."""

    x_dot: ca.SX
    acceleration: ca.SX
    F_z: ca.SX
    F_l: ca.SX
    F_t: ca.SX
    alpha: ca.SX


def wheel_loads(car: DoubleTrackCar, a_x: ca.SX, a_y: ca.SX) -> ca.SX:
    """F_z (4) [N] of a rigid car (Kiencke, Nielsen): their sum is m g whatever the accelerations; may be negative."""
    p = car.planar
    front = p.m * (p.l_R * p.g - car.h * a_x) / p.wheelbase
    rear = p.m * (p.l_F * p.g + car.h * a_x) / p.wheelbase
    # without width there is no lever for the transfer, and left equals right
    narrow = isinstance(car.d, float) and not car.d
    share = 0 if narrow else car.h * a_y / (2 * car.d * p.g)
    return ca.vertcat(front * (0.5 - share), front * (0.5 + share), rear * (0.5 - share), rear * (0.5 + share))


def slip_angles(car: DoubleTrackCar, x: ca.SX) -> ca.SX:
    """alpha (4) [rad]; both front wheels steer by delta."""
    v, beta, omega_z, delta = x[2], x[3], x[5], x[6]
    directions = [
        ca.atan2(v * ca.sin(beta) + omega_z * X, v * ca.cos(beta) - omega_z * Y) for X, Y in car.wheel_positions
    ]
    return ca.vertcat(delta, delta, 0, 0) - ca.vertcat(*directions)


def motion(car: DoubleTrackCar, x: ca.SX, u: ca.SX, a: ca.SX, friction: ca.SX | float | None = None) -> Motion:
    """The motion with the wheel loads of the accelerations a = (a_x, a_y) [m/s2].

    Loads and accelerations determine each other; `a` from the step before breaks the loop. With `friction` the
    lateral forces shrink by the friction ellipse of each wheel.
    """
    p = car.planar
    F_z = ca.fmax(wheel_loads(car, a[0], a[1]), car.least_load)
    alpha = slip_angles(car, x)
    F_t = _lateral_forces(car, alpha, F_z)
    if friction is not None:
        F_t = F_t * ellipse(u[1:], F_z, friction)
    F_l = u[1:] - rolling_coefficient(p, x[2]) * F_z
    steer = ca.vertcat(x[6], x[6], 0, 0)
    f_x, f_y = F_l * ca.cos(steer) - F_t * ca.sin(steer), F_l * ca.sin(steer) + F_t * ca.cos(steer)
    X, Y = (ca.vertcat(*column) for column in zip(*car.wheel_positions, strict=True))
    F_x, F_y = ca.sum1(f_x) - air_drag(p, x[2]), ca.sum1(f_y)
    x_dot = planar_motion(p, x, u[0], (F_x, F_y, ca.dot(X, f_y) - ca.dot(Y, f_x)))
    return Motion(x_dot, ca.vertcat(F_x, F_y) / p.m, F_z, F_l, F_t, alpha)


def function(car: DoubleTrackCar, friction: float | None = None) -> ca.Function:
    """f(x, u, a) -> x_dot, acceleration, F_z, F_l, F_t, alpha."""
    x, u, a = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(INPUTS)), ca.SX.sym("a", 2)
    found = motion(car, x, u, a, friction)
    names = ["x_dot", "acceleration", "F_z", "F_l", "F_t", "alpha"]
    values = ca.cse([getattr(found, name) for name in names])
    return ca.Function("double_track", [x, u, a], values, ["x", "u", "a"], names)


def _lateral_forces(car: DoubleTrackCar, alpha: ca.SX, F_z: ca.SX) -> ca.SX:
    """F_t (4) [N]: the axle's formula, its peak in proportion to the wheel's load."""
    p = car.planar
    axles = ((p.front, p.static_loads[0]),) * 2 + ((p.rear, p.static_loads[1]),) * 2
    forces = [lateral(tyre, alpha[i], tyre.D * F_z[i] / static) for i, (tyre, static) in enumerate(axles)]
    return ca.vertcat(*forces)
