"""Stages 1 and 2 in one joint covariance: the kinematic differential equation of navigation and its propagation.

All of it lives in the level frame: yawed with the car, not rolled or pitched, so that gravity has no component in it.
"""

from __future__ import annotations

from functools import cache

import casadi as ca

from fmukit.kernel import Layout, Parts, block
from fmus.cars.rotation import rotation_plane

STATE = Layout(heading=1, gyroscope_bias=1, position=2, velocity=2, accelerometer_bias=2, gps_error=2)
"""psi [rad], b_g [rad/s] (stage 1); p [m] world, w [m/s] and b_a [m/s2] level, c [m] slow receiver error (stage 2)."""
STAGE_1, STAGE_2 = slice(0, 2), slice(2, 10)
PACKED = STATE.size * (STATE.size + 1) // 2
BELIEF = Layout(mean=STATE.size, covariance=PACKED)
READING = Layout(yaw_rate=1, acceleration=2)
PROCESS = Layout(gyroscope=1, gyroscope_bias=1, accelerometer=1, accelerometer_bias=1, gps_error=1, gps_decay=1)
"""Densities n^2 of the four noises, variance of c [m2] and 1/tau [1/s]."""


@block(belief=BELIEF, reading=READING, T=1, process=PROCESS)
def propagate(belief: Parts, reading: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """The belief (column of BELIEF) a time T [s] later; T = 0 is the identity.

    The mean is the exact solution for a constant reading, Phi its Jacobian, Q the van Loan integral up to T^3.
    """
    z, P = belief["mean"], full(belief["covariance"])
    forward = transition(z, reading, T, process)
    Phi = ca.jacobian(forward, z)
    return ca.vertcat(forward, pack(Phi @ P @ Phi.T + noise(z, reading, T, process)))


@block(symbol=ca.MX, belief=BELIEF.size, reading=READING.size, T=1, process=PROCESS.size)
def stay(belief: ca.MX, reading: ca.MX, T: ca.MX, process: ca.MX) -> ca.MX:
    """The belief as it is: what is taken in place of `propagate`."""
    return belief


@cache
def propagate_if() -> ca.Function:
    """(condition, belief, reading, T, process) -> `propagate` if the condition holds, else `stay`."""
    return ca.Function.if_else("propagate_if", propagate.function, stay.function)


def derivative(z: ca.SX, reading: Parts, process: Parts) -> ca.SX:
    """z' of the mean: psi' = r, p' = Rz(psi) w, w' = a - b_a - r x w, c' = -c/tau, r = omega - b_g."""
    s, m = STATE.split(z), reading
    r, a = m["yaw_rate"] - s["gyroscope_bias"], m["acceleration"] - s["accelerometer_bias"]
    rates = {
        "heading": r,
        "gyroscope_bias": ca.SX(1, 1),
        "position": rotation_plane(s["heading"]) @ s["velocity"],
        "velocity": a - r * quarter_turn(s["velocity"]),
        "accelerometer_bias": ca.SX(2, 1),
        "gps_error": -process["gps_decay"] * s["gps_error"],
    }
    return STATE.join(rates)


def transition(z: ca.SX, reading: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """z after T: with alpha = r T, w+ = Rz(-alpha)(w + T J a), p+ = p + Rz(psi)(T w + T^2 K a).

    J and K are the first and second integral of the rotation, as series exact to alpha^6 (alpha is a few mrad).
    """
    s, m = STATE.split(z), reading
    r, a = m["yaw_rate"] - s["gyroscope_bias"], m["acceleration"] - s["accelerometer_bias"]
    alpha, w = r * T, s["velocity"]
    later = s | {
        "heading": s["heading"] + alpha,
        "position": s["position"] + rotation_plane(s["heading"]) @ (T * w + T**2 * (_series(alpha, 2) @ a)),
        "velocity": _series(-alpha, 0) @ (w + T * (_series(alpha, 1) @ a)),
        "gps_error": ca.exp(-T * process["gps_decay"]) * s["gps_error"],
    }
    return STATE.join(later)


def noise(z: ca.SX, reading: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """Q = Qc T + (A Qc + Qc A') T^2/2 + (A^2 Qc + 2 A Qc A' + Qc A'^2) T^3/6, A = dz'/dz.

    Sensor noise enters as the sensor's bias does; the walks enter the biases.
    """
    q = process
    A = ca.jacobian(derivative(z, reading, process), z)
    Qc = q["gyroscope"] * A[:, 1] @ A[:, 1].T + q["accelerometer"] * A[:, 6:8] @ A[:, 6:8].T
    walks = (q["gyroscope_bias"], q["accelerometer_bias"], q["accelerometer_bias"])
    for index, density in zip((1, 6, 7), walks, strict=True):
        Qc[index, index] += density
    for index in (8, 9):
        Qc[index, index] += 2 * q["gps_decay"] * q["gps_error"]
    AQ = A @ Qc
    AAQ = A @ AQ
    return Qc * T + (AQ + AQ.T) * T**2 / 2 + (AAQ + 2 * AQ @ A.T + AAQ.T) * T**3 / 6


def quarter_turn(vector: ca.SX) -> ca.SX:
    """e_z x vector in the plane."""
    return ca.vertcat(-vector[1], vector[0])


def full(packed: ca.SX) -> ca.SX:
    """The covariance (10 x 10) of its lower triangle, column by column."""
    return ca.tril2symm(ca.SX(ca.Sparsity.lower(STATE.size), packed))


def pack(P: ca.SX) -> ca.SX:
    """The lower triangle of a covariance, column by column."""
    return ca.vertcat(*(P[i, j] for j in range(STATE.size) for i in range(j, STATE.size)))


def _series(alpha: ca.SX, order: int) -> ca.SX:
    """Sum over k of (alpha S)^k / (k + order)!, S the quarter turn: the rotation integrated `order` times on [0, 1]."""
    factorial = [1.0]
    for k in range(1, 10):
        factorial.append(factorial[-1] * k)
    even = sum(sign * alpha**k / factorial[k + order] for k, sign in ((0, 1), (2, -1), (4, 1), (6, -1)))
    odd = sum(sign * alpha**k / factorial[k + order] for k, sign in ((1, 1), (3, -1), (5, 1), (7, -1)))
    return ca.vertcat(ca.horzcat(even, -odd), ca.horzcat(odd, even))
