"""Single-track car: x' of the seven states under steering rate and the longitudinal forces of both axles."""

from __future__ import annotations

import casadi as ca

from fmus.cars.single_track import SingleTrackCar
from fmus.single_track.forces import STATES, air_drag, ellipse, lateral, planar_motion, rolling_coefficient

INPUTS = ("omega_delta", "U_F", "U_R")
"""Steering rate [rad/s], drive (> 0) or brake force of the front and of the rear axle [N]."""


def slips(car: SingleTrackCar, x: ca.SX) -> tuple[ca.SX, ca.SX]:
    """alpha_F, alpha_R [rad], thesis eqs. (3.3), (3.4), the latter with l_R."""
    _, _, v, beta, _, omega_z, delta = ca.vertsplit(x)
    v_x, v_y = v * ca.cos(beta), v * ca.sin(beta)
    return delta - ca.atan((v_y + car.l_F * omega_z) / v_x), ca.atan((car.l_R * omega_z - v_y) / v_x)


def derivative(car: SingleTrackCar, x: ca.SX, u: ca.SX, friction: ca.SX | float | None = None) -> ca.SX:
    """x' (7); with `friction` the lateral forces shrink by the friction ellipse."""
    v, delta = x[2], x[6]
    loads, U = car.static_loads, (u[1], u[2])
    F_t = [lateral(tyre, alpha) for tyre, alpha in zip((car.front, car.rear), slips(car, x), strict=True)]
    if friction is not None:
        F_t = [F * ellipse(U_j, F_z, friction) for F, U_j, F_z in zip(F_t, U, loads, strict=True)]
    f_r = rolling_coefficient(car, v)
    F_l = [U_j - f_r * F_z for U_j, F_z in zip(U, loads, strict=True)]
    c, s = ca.cos(delta), ca.sin(delta)
    F_y_front = F_t[0] * c + F_l[0] * s
    F_x = F_l[0] * c - F_t[0] * s + F_l[1] - air_drag(car, v)
    M_z = car.l_F * F_y_front - car.l_R * F_t[1]
    return planar_motion(car, x, u[0], (F_x, F_y_front + F_t[1], M_z))


def function(car: SingleTrackCar, friction: float | None = None) -> ca.Function:
    """f(x, u) -> x_dot."""
    x, u = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", len(INPUTS))
    x_dot = ca.cse(derivative(car, x, u, friction))
    return ca.Function("single_track", [x, u], [x_dot], ["x", "u"], ["x_dot"])
