"""The state of the filter and its propagation: the kinematic differential equation of navigation.

Velocity lives in the level frame: yawed with the car, not rolled or pitched, so that gravity has no component in it.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, block
from fmus.cars.rotation import angle_rates, levelling, rotation_plane

STATE = Layout(
    heading=1,
    position=2,
    velocity=2,
    tilt=2,
    gyroscope_bias=3,
    accelerometer_bias=2,
    gps_error=2,
    load_lean=2,
    load_share=2,
)
"""psi [rad], p [m] world, w [m/s] level, (phi, theta) [rad], b_g [rad/s] and b_a [m/s2] body, c [m] slow receiver
error, and what a load makes wrong in the readings of roll and pitch: o [rad] and s [rad/(m/s2)], see `attitude`."""
PACKED = STATE.size * (STATE.size + 1) // 2
BELIEF = Layout(mean=STATE.size, covariance=PACKED)
UNIT = Layout(rate=3, force=3)
"""What the inertial unit reads: angular velocity now [rad/s], mean specific force since the last reading [m/s2]."""
PROCESS = Layout(gyroscope=1, gyroscope_bias=1, accelerometer=1, accelerometer_bias=1, gps_error=1, gps_decay=1, lean=1)
"""Densities n^2 of the noises and walks of the unit, variance of c [m2], 1/tau [1/s], density of the walk of o."""


@block(belief=BELIEF, unit=UNIT, T=1, process=PROCESS)
def propagate(belief: Parts, unit: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """The belief (column of BELIEF) a time T [s] later; `unit` is the mean reading over T; T = 0 is the identity.

    Phi is the Jacobian of the transition, Q the van Loan integral up to T^3.
    """
    z, P = belief["mean"], full(belief["covariance"])
    forward = transition(z, unit, T, process)
    Phi = ca.jacobian(forward, z)
    return ca.vertcat(forward, pack(Phi @ P @ Phi.T + noise(z, unit, T, process)))


def motion(s: Parts, unit: Parts) -> tuple[ca.SX, ca.SX]:
    """(phi', theta', psi') [rad/s] and the acceleration in the plane of the level frame [m/s2], biases removed."""
    phi, theta = s["tilt"][0], s["tilt"][1]
    force = unit["force"] - ca.vertcat(s["accelerometer_bias"], 0)
    rates = ca.vertcat(*angle_rates(phi, theta, unit["rate"] - s["gyroscope_bias"]))
    return rates, (levelling(phi, theta) @ force)[0:2]


def derivative(z: ca.SX, unit: Parts, process: Parts) -> ca.SX:
    """z' of the mean: p' = Rz(psi) w, w' = a - psi' e_z x w, c' = -c/tau, the angles' rates, all else 0."""
    s = STATE.split(z)
    rates, a = motion(s, unit)
    return STATE.begun(
        {
            "heading": rates[2],
            "position": rotation_plane(s["heading"]) @ s["velocity"],
            "velocity": a - rates[2] * quarter_turn(s["velocity"]),
            "tilt": rates[0:2],
            "gps_error": -process["gps_decay"] * s["gps_error"],
        }
    )


def transition(z: ca.SX, unit: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """z after T: with alpha = psi' T, w+ = Rz(-alpha)(w + T J a), p+ = p + Rz(psi)(T w + T^2 K a).

    Roll and pitch follow the midpoint rule; psi' and a are those at the midpoint. J and K are the first and second
    integral of the rotation, as series exact to alpha^6 (alpha is a few mrad).
    """
    s = STATE.split(z)
    middle = s | {"tilt": s["tilt"] + T / 2 * motion(s, unit)[0][0:2]}
    rates, a = motion(middle, unit)
    alpha, w = rates[2] * T, s["velocity"]
    later = s | {
        "heading": s["heading"] + alpha,
        "position": s["position"] + rotation_plane(s["heading"]) @ (T * w + T**2 * (_series(alpha, 2) @ a)),
        "velocity": _series(-alpha, 0) @ (w + T * (_series(alpha, 1) @ a)),
        "tilt": s["tilt"] + T * rates[0:2],
        "gps_error": ca.exp(-T * process["gps_decay"]) * s["gps_error"],
    }
    return STATE.join(later)


def noise(z: ca.SX, unit: Parts, T: ca.SX, process: Parts) -> ca.SX:
    """Q = Qc T + (A Qc + Qc A') T^2/2 + (A^2 Qc + 2 A Qc A' + Qc A'^2) T^3/6, A = dz'/dz.

    Sensor noise enters as the sensor's bias does; the walks enter the biases.
    """
    q = process
    A = ca.jacobian(derivative(z, unit, process), z)
    Qc = ca.SX(STATE.size, STATE.size)
    for name, density in (("gyroscope_bias", q["gyroscope"]), ("accelerometer_bias", q["accelerometer"])):
        into = A[:, where(name)]
        Qc += density * into @ into.T
    walks = {name: q[name] for name in ("gyroscope_bias", "accelerometer_bias")}
    walks |= {"gps_error": 2 * q["gps_decay"] * q["gps_error"], "load_lean": q["lean"]}
    for name, density in walks.items():
        for index in where(name):
            Qc[index, index] += density
    AQ = A @ Qc
    AAQ = A @ AQ
    return Qc * T + (AQ + AQ.T) * T**2 / 2 + (AAQ + 2 * AQ @ A.T + AAQ.T) * T**3 / 6


def where(name: str) -> list[int]:
    """The indices of a part of the state."""
    names = list(STATE.sizes)
    first = sum(STATE.sizes[other] for other in names[: names.index(name)])
    return list(range(first, first + STATE.sizes[name]))


def quarter_turn(vector: ca.SX) -> ca.SX:
    """e_z x vector in the plane."""
    return ca.vertcat(-vector[1], vector[0])


def full(packed: ca.SX) -> ca.SX:
    """The covariance of its lower triangle, column by column."""
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
