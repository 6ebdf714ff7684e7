"""Roll and pitch: two scalar Kalman filters that join the gyroscope with suspension travel and tyre compliance."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals
from fmus.cars.rotation import angle_rates

STATE = Layout(roll=1, roll_bias=1, pitch=1, pitch_bias=1, roll_covariance=3, pitch_covariance=3)
"""phi, b_p, theta, b_q and the covariances (angle, angle-bias, bias) of each pair."""


def step(x: Parts, rate: ca.SX, reading: ca.SX, T: ca.SX, p: Signals) -> Parts:
    """Attitude a time T later, updated with `reading` = (roll, pitch); `rate` (3) is the measured mean rate over T.

    The z bias is left in: it enters only through roll and pitch times itself.

    phi' = omega_x + tan(theta) (omega_y sin(phi) + omega_z cos(phi)), theta' = omega_y cos(phi) - omega_z sin(phi).
    """
    phi_dot, theta_dot, _ = angle_rates(x["roll"], x["pitch"], rate - ca.vertcat(x["roll_bias"], x["pitch_bias"], 0))
    return _axis("roll", x, phi_dot, reading[0], T=T, p=p) | _axis("pitch", x, theta_dot, reading[1], T=T, p=p)


def _axis(name: str, x: Parts, rate: ca.SX, reading: ca.SX, *, T: ca.SX, p: Signals) -> Parts:
    """One pair [angle, bias]: angle' = rate (bias already removed), bias a random walk, then a Joseph update."""
    angle, bias, P = x[name], x[f"{name}_bias"], x[f"{name}_covariance"]
    q_g, q_b, r = p["noise.gyroscope"] ** 2, p["noise.gyroscope_bias"] ** 2, p["noise.attitude"] ** 2
    p11 = P[0] - 2 * T * P[1] + T**2 * P[2] + T * q_g + T**3 / 3 * q_b
    p12, p22 = P[1] - T * P[2] - T**2 / 2 * q_b, P[2] + T * q_b
    k1, k2 = p11 / (p11 + r), p12 / (p11 + r)
    gap, rest = reading - (angle + T * rate), 1 - k1
    j11 = rest**2 * p11 + k1**2 * r
    j12 = rest * (p12 - k2 * p11) + k1 * k2 * r
    j22 = k2**2 * (p11 + r) - 2 * k2 * p12 + p22
    mean = {name: angle + T * rate + k1 * gap, f"{name}_bias": bias + k2 * gap}
    return mean | {f"{name}_covariance": ca.vertcat(j11, j12, j22)}


def quasi_static(travel: ca.SX, force: ca.SX, p: Signals) -> ca.SX:
    """(roll, pitch) of the body over a flat road: suspension travel (4) [m] plus the tyres' share.

    phi = atan(mean over axles of (q_right - q_left)/d) + m h f_y / (c_z d^2)
    theta = atan((q_front - q_rear)/L) - m h f_x / (c_z L^2)
    The specific force `force` (2) contains the gravity of a tilted car, hence the overturning moment as well.
    """
    fl, fr, rl, rr = ca.vertsplit(travel)
    d, L, c_z = p["design.track"], p["design.wheelbase"], p["design.tyre_stiffness"]
    moment = p["design.mass"] * p["design.cog_height"] * force
    roll = ca.atan((fr + rr - fl - rl) / (2 * d)) + moment[1] / (c_z * d**2)
    pitch = ca.atan((fl + fr - rl - rr) / (2 * L)) - moment[0] / (c_z * L**2)
    return ca.vertcat(roll, pitch)
