"""Forces on a car that moves in the plane, and the motion they give. Shared by single- and double-track."""

from __future__ import annotations

import casadi as ca

from fmus.cars.single_track import SingleTrackCar, Tyre

STATES = ("x", "y", "v", "beta", "psi", "omega_z", "delta")
"""Position [m], speed [m/s], sideslip [rad] (> 0: the velocity points left), yaw, yaw rate, steering angle."""

_FLOOR = 1e-4
"""Keeps the friction ellipse differentiable where the longitudinal force takes all grip (engineering choice)."""


def lateral(tyre: Tyre, alpha: ca.SX, D: ca.SX | float | None = None) -> ca.SX:
    """Magic formula, thesis eq. (3.5): lateral force [N] of slip angle alpha [rad]; `D` replaces the axle's peak."""
    Ba = tyre.B * alpha
    return (tyre.D if D is None else D) * ca.sin(tyre.C * ca.atan(Ba - tyre.E * (Ba - ca.atan(Ba))))


def ellipse(U: ca.SX, F_z: ca.SX | float, friction: ca.SX | float) -> ca.SX:
    """Part of the lateral force left beside the longitudinal force U [N]: sqrt(1 - (U / (mu F_z))^2), kept above 0."""
    return ca.sqrt(ca.fmax(1 - (U / (friction * F_z)) ** 2, 0) + _FLOOR)


def rolling_coefficient(car: SingleTrackCar, v: ca.SX) -> ca.SX:
    """f_r(v), thesis eq. (3.6), v in m/s."""
    constant, linear, quartic = car.rolling
    return constant + linear * v + quartic * v**4


def air_drag(car: SingleTrackCar, v: ca.SX) -> ca.SX:
    """F_a [N]."""
    return car.drag * v**2


def planar_motion(car: SingleTrackCar, x: ca.SX, omega_delta: ca.SX, load: tuple[ca.SX, ca.SX, ca.SX]) -> ca.SX:
    """x' (7) of the states under steering rate [rad/s] and load: body-frame F_x, F_y [N] and moment M_z [N.m]."""
    F_x, F_y, M_z = load
    _, _, v, beta, psi, omega_z, _ = ca.vertsplit(x)
    c, s = ca.cos(beta), ca.sin(beta)
    return ca.vertcat(
        v * ca.cos(psi + beta),
        v * ca.sin(psi + beta),
        (F_x * c + F_y * s) / car.m,
        -omega_z + (F_y * c - F_x * s) / (car.m * v),
        omega_z,
        M_z / car.I_zz,
        omega_delta,
    )
