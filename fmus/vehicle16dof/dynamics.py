"""The equations of motion, solved by eliminating the legs: cost of a 3x3 system per evaluation.

Knuckles and wheels have their centres of gravity in the wheel centre, wheels are axisymmetric and suspensions slide
along z_1, so each leg is a point mass m_u that slides, plus a rotor. Its block of M is diagonal in (q, delta, Omega):
the leg equations give its vertical force, kingpin moment and axle moment outright, and what is left for the base
are the horizontal inertia of the point masses and the inertia of the legs about the axes their joints do not free.
Linear accelerations are then eliminated too (their block is diagonal), leaving K eps = m, K symmetric 3x3.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Parts, Signals
from fmus.vehicle16dof.states import over_wheels, symmetric, unsprung_mass


@dataclass(frozen=True, slots=True)
class Leg:
    """State and generalised forces of one corner: forces Q along q [N], about delta and Omega [N.m]."""

    place: ca.SX  # wheel centre in K1
    travel_rate: ca.SX
    sine: ca.SX  # of the steering angle
    cosine: ca.SX
    steer_rate: ca.SX
    spin: ca.SX
    steered: bool
    Q_travel: ca.SX
    Q_steer: ca.SX
    Q_spin: ca.SX


@dataclass(frozen=True, slots=True)
class Accelerations:
    """Specific force of O1 and angular acceleration in K1, and the joint accelerations."""

    specific_force: ca.SX
    angular: ca.SX
    travel: ca.SX
    steer: ca.SX
    spin: ca.SX


@dataclass(frozen=True, slots=True)
class _Reduced:
    """What one leg leaves to the base: its inertia K, the force and moment that do not depend on accelerations."""

    K: ca.SX
    force: ca.SX
    moment: ca.SX
    b: ca.SX  # velocity-dependent acceleration of the wheel centre
    rates: tuple[ca.SX, ca.SX, ca.SX]  # carrier angular velocity in the steered frame
    H: tuple[ca.SX, ca.SX, ca.SX]  # angular momentum about the wheel centre, steered frame


def accelerations(p: Signals, d: Parts, omega: ca.SX, legs: list[Leg], *, force: ca.SX, moment: ca.SX) -> Accelerations:
    """Solve M u' + h = Q; `force` [N] and `moment` [N.m] about O1 sum everything external, in K1."""
    m_u = unsprung_mass(p)
    reduced = [_reduce(p, m_u, omega, leg) for leg in legs]
    J, rho = symmetric(d["inertia"]), d["mass_moment"]
    F = force - ca.cross(omega, ca.cross(omega, rho)) - _sum([leg.force for leg in reduced])
    N = moment - ca.cross(omega, J @ omega) - _sum([leg.moment for leg in reduced])
    first = ca.vertcat(d["unsprung_moment"], m_u * over_wheels([leg.place[2] for leg in legs]))
    coupling = _coupling(rho + first, rho)
    inverse = ca.diag(ca.vertcat(d["inverse_mass"][1], d["inverse_mass"][1], d["inverse_mass"][0]))
    K = J + _sum([leg.K for leg in reduced]) - coupling.T @ inverse @ coupling
    K[2, 2] += d["unsprung_inertia"]
    eps = _solve(K, N - coupling.T @ (inverse @ F))
    a = inverse @ (F - coupling @ eps)
    joints = [_joint_accelerations(p, leg, own, a, eps) for leg, own in zip(legs, reduced, strict=True)]
    travel, steer, spin = (ca.vertcat(*column) for column in zip(*joints, strict=True))
    return Accelerations(a, eps, travel, steer[:2], spin)


def _coupling(all_masses: ca.SX, sprung: ca.SX) -> ca.SX:
    """d force / d eps [kg m]: horizontally all masses follow the base, vertically the sprung mass alone."""
    (c_x, c_y, c_z), (r_x, r_y, _) = ca.vertsplit(all_masses), ca.vertsplit(sprung)
    return ca.vertcat(ca.horzcat(0, c_z, -c_y), ca.horzcat(-c_z, 0, c_x), ca.horzcat(r_y, -r_x, 0))


def inertias(p: Signals) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Inertia of knuckle and wheel about the steered axes, the wheel's spin excepted [kg m2]."""
    across = p["wheel.inertia.diametral"]
    return p["knuckle.inertia.x"] + across, p["knuckle.inertia.y"], p["knuckle.inertia.z"] + across


def _reduce(p: Signals, m_u: ca.SX, omega: ca.SX, leg: Leg) -> _Reduced:
    P, (w_1, w_2, w_3) = leg.place, ca.vertsplit(omega)
    b = omega * ca.dot(omega, P) - ca.dot(omega, omega) * P + 2 * leg.travel_rate * ca.vertcat(w_2, -w_1, 0)
    force = ca.vertcat(m_u * b[0], m_u * b[1], leg.Q_travel)
    s, c, turn = leg.sine, leg.cosine, leg.steer_rate
    A, B, C = inertias(p)
    w_x, w_y, w_z = c * w_1 + s * w_2, c * w_2 - s * w_1, w_3 + turn
    H = (A * w_x, B * w_y + p["wheel.inertia.spin"] * (w_y + leg.spin), C * w_z)
    h_x = A * turn * w_y + w_y * H[2] - w_z * H[1]
    h_y = leg.Q_spin - B * turn * w_x + w_z * H[0] - w_x * H[2]
    h_z = leg.Q_steer if leg.steered else w_x * H[1] - w_y * H[0]
    moment = ca.cross(P, force) + ca.vertcat(c * h_x - s * h_y, s * h_x + c * h_y, h_z)
    return _Reduced(_leg_inertia(m_u, leg, A, B, C), force, moment, b, (w_x, w_y, w_z), H)


def _leg_inertia(m_u: ca.SX, leg: Leg, A: ca.SX, B: ca.SX, C: ca.SX) -> ca.SX:
    """K of one leg, less the constant m_u (x^2 + y^2) about z, which is summed in `unsprung_inertia`."""
    x, y, z = ca.vertsplit(leg.place)
    s, c = leg.sine, leg.cosine
    xx, yy, xy = A * c * c + B * s * s, A * s * s + B * c * c, (A - B) * s * c
    mz = m_u * z
    return symmetric(ca.vertcat(xx + mz * z, yy + mz * z, 0 if leg.steered else C, xy, -mz * x, -mz * y))


def _joint_accelerations(p: Signals, leg: Leg, own: _Reduced, a: ca.SX, eps: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    x, y, _ = ca.vertsplit(leg.place)
    (w_x, w_y, _), (H_x, H_y, _) = own.rates, own.H
    travel = leg.Q_travel / unsprung_mass(p) - (a[2] + eps[0] * y - eps[1] * x + own.b[2])
    steer = (leg.Q_steer - w_x * H_y + w_y * H_x) / inertias(p)[2] - eps[2] if leg.steered else ca.SX(0)
    axle = leg.cosine * eps[1] - leg.sine * eps[0] - leg.steer_rate * w_x
    return travel, steer, leg.Q_spin / p["wheel.inertia.spin"] - axle


def _solve(K: ca.SX, m: ca.SX) -> ca.SX:
    """K^-1 m by L D L' of the symmetric positive definite 3x3 matrix K."""
    i_1 = 1 / K[0, 0]
    l_21, l_31 = K[0, 1] * i_1, K[0, 2] * i_1
    i_2 = 1 / (K[1, 1] - l_21 * K[0, 1])
    k_32 = K[1, 2] - l_31 * K[0, 1]
    l_32 = k_32 * i_2
    i_3 = 1 / (K[2, 2] - l_31 * K[0, 2] - l_32 * k_32)
    y_2 = m[1] - l_21 * m[0]
    x_3 = (m[2] - l_31 * m[0] - l_32 * y_2) * i_3
    x_2 = y_2 * i_2 - l_32 * x_3
    return ca.vertcat(m[0] * i_1 - l_21 * x_2 - l_31 * x_3, x_2, x_3)


def _sum(columns: list[ca.SX]) -> ca.SX:
    return over_wheels(columns)
