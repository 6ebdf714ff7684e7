"""Gibbs-Appell equations of any tree on a moving base: M(q) u' + h(q, u) = Q. The reference form.

Velocity u = (v_1; omega_1; q'), v_1 and omega_1 in K1. Every body has the Gibbs function (acceleration terms only)
    G_j = m a.a/2 + a.(eps x mrho) + a.(omega x (omega x mrho)) + eps.J eps/2 + eps.(omega x J omega)
with a_j = a_1-recursion including -g. With (a_j; eps_j) = Phi_j u' + gamma_j, dG/du' = Q gives
    M = sum Phi' J Phi,   h = sum Phi' (J gamma + beta),   beta = (omega x (omega x mrho); omega x J omega).
"""

from __future__ import annotations

from collections.abc import Sequence

import casadi as ca

from tests.references.tree import Body, Joint


def mass_and_bias(
    joints: Sequence[Joint], bodies: Sequence[Body], q: ca.SX, u: ca.SX, gravity: ca.SX
) -> tuple[ca.SX, ca.SX]:
    """M (n x n) and h (n) for n = 6 + len(joints); `gravity` is the vector g in K1 [m/s2]."""
    n = 6 + len(joints)
    omega = u[3:6]
    motions = [(omega, ca.SX.eye(n)[:6, :], ca.vertcat(ca.cross(omega, u[:3]) - gravity, ca.SX.zeros(3)))]
    for j, joint in enumerate(joints):
        motions.append(_next(joint, q[j], u[6 + j], 6 + j, motions[joint.antecedent]))
    M, h = ca.SX(n, n), ca.SX.zeros(n)
    for body, (omega, Phi, gamma) in zip(bodies, motions, strict=True):
        inertia = _spatial_inertia(body)
        M += Phi.T @ inertia @ Phi
        h += Phi.T @ (inertia @ gamma + _bias(body, omega))
    return M, h


_Moving = tuple[ca.SX, ca.SX, ca.SX]


def _next(joint: Joint, q: ca.SX, rate: ca.SX, column: int, antecedent: _Moving) -> _Moving:
    """(omega_j, Phi_j, gamma_j) from those of the antecedent."""
    omega_i, Phi_i, gamma_i = antecedent
    iRj, P = joint.transform(q)
    R = iRj.T
    e = ca.SX([0, 0, 1])
    omega = R @ omega_i
    coriolis = ca.cross(omega, rate * e)
    Phi = _shift(R, P) @ Phi_i
    gamma = _shift(R, P) @ gamma_i + ca.vertcat(R @ ca.cross(omega_i, ca.cross(omega_i, P)), ca.SX.zeros(3))
    if joint.prismatic:
        Phi[2, column] += 1
        gamma += ca.vertcat(2 * coriolis, ca.SX.zeros(3))
        return omega, Phi, gamma
    Phi[5, column] += 1
    gamma += ca.vertcat(ca.SX.zeros(3), coriolis)
    return omega + rate * e, Phi, gamma


def _shift(R: ca.SX, P: ca.SX) -> ca.SX:
    """[[R, -R [P]x], [0, R]]."""
    return ca.vertcat(ca.horzcat(R, -R @ ca.skew(P)), ca.horzcat(ca.SX(3, 3), R))


def _spatial_inertia(body: Body) -> ca.SX:
    moment = ca.skew(body.mass_moment)
    return ca.vertcat(ca.horzcat(body.mass * ca.SX.eye(3), -moment), ca.horzcat(moment, body.inertia))


def _bias(body: Body, omega: ca.SX) -> ca.SX:
    spun = ca.cross(omega, ca.cross(omega, body.mass_moment))
    return ca.vertcat(spun, ca.cross(omega, body.inertia @ omega))
