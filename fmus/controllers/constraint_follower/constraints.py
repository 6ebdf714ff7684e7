"""Constraints between vehicles, their rates, and the multipliers that keep them, for any number of vehicles.

A vehicle is q_i = (h_x, h_y, psi): its hand point and its yaw angle. C(q, s) = 0 binds the coordinates q that the
constraint forces move, and may depend on driven coordinates s, whose motion is given:

    C' = W q' + C_s s',   W = dC/dq,        C'' = W q'' + gamma

with gamma = W' q' + (C_s s')' at q'' = 0. Vehicles move as q'' = B u + n, where u are accelerations of equal virtual
mass, B the directions in which they act. Constraint forces act through W' like Lagrange's, on what a vehicle can do
through B', so u = -(W B)' lambda, and C'' = -K_d C' - K_p C needs

    (W B)(W B)' lambda = W n + gamma + K_d C' + K_p C
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmus.cars.rotation import rotation_plane, wrap

COORDINATES = 3
"""Coordinates of a vehicle: h_x [m], h_y [m], psi [rad]."""
REGULARISATION = 1e-6
"""Added to the diagonal, for rows of length about one."""
INDEPENDENT = 1e-4
"""Squared length above which a direction counts as reached by rows of length about one."""


class Multipliers(NamedTuple):
    """lambda (m), and what the rows lack of the acceleration they ask for (m)."""

    value: ca.SX
    residual: ca.SX


def offset(q_i: ca.SX, q_j: ca.SX, r: ca.SX) -> ca.SX:
    """h_i - h_j - R(psi_j) r [m] (2): vehicle i is wanted at r (2) from j, in the axes of j."""
    return q_i[:2] - q_j[:2] - rotation_plane(q_j[2]) @ r


def distance(q_i: ca.SX, q_j: ca.SX, r: ca.SX) -> ca.SX:
    """(|h_i - h_j|^2 - |r|^2)/2 [m2] (1): the hands are |r| apart. Without direction where they coincide."""
    return 0.5 * (ca.sumsqr(q_i[:2] - q_j[:2]) - ca.sumsqr(r))


def trajectory(q_i: ca.SX, s: ca.SX) -> ca.SX:
    """h_i - s [m] (2): the hand is on a driven point; the offset zero from a vehicle that only exists in thought."""
    return offset(q_i, s, ca.SX.zeros(2))


def heading(q_i: ca.SX, q_j: ca.SX) -> ca.SX:
    """psi_i - psi_j [rad] (1), wrapped."""
    return wrap(q_i[2] - q_j[2])


def rows(C: ca.SX, q: ca.SX, s: ca.SX, fixed: ca.SX) -> ca.Function:
    """(q, q', s, s', s'', fixed) -> (C, W, C', gamma) of the rows C, an expression in these symbols."""
    dq, ds, dds = ca.SX.sym("dq", q.numel()), ca.SX.sym("ds", s.numel()), ca.SX.sym("dds", s.numel())
    rate = ca.jtimes(C, q, dq) + ca.jtimes(C, s, ds)
    gamma = ca.jtimes(rate, q, dq) + ca.jtimes(rate, s, ds) + ca.jtimes(C, s, dds)
    return ca.Function("rows", [q, dq, s, ds, dds, fixed], [C, ca.densify(ca.jacobian(C, q)), rate, gamma])


def directions(psi: ca.SX, a: ca.SX | float) -> ca.SX:
    """B (3 x 2) of a vehicle that does not slide, for u = (v', a omega') [m/s2]."""
    return ca.vertcat(rotation_plane(psi), ca.horzcat(0, 1 / a))


def drift(psi: ca.SX, velocity: ca.SX, omega: ca.SX, a: ca.SX | float) -> ca.SX:
    """n (3): h'' and psi'' at u = 0, from the velocity of O1 in body axes (2); h'' = R (v' - a w^2 - w v_y, ...)."""
    body = ca.vertcat(-omega * (velocity[1] + a * omega), omega * velocity[0])
    return ca.vertcat(rotation_plane(psi) @ body, 0)


def multipliers(G: ca.SX, b: ca.SX) -> Multipliers:
    """lambda of (G G' + eps I) lambda = b, with G = W B and b = W n + gamma + K_d C' + K_p C.

    Positive definite for every G: dependent and contradictory rows give the compromise of least squares, whose
    residual is eps lambda, and a row switched off (zero in G and b) has lambda zero.
    """
    x = solve(G @ G.T + REGULARISATION * ca.SX.eye(G.shape[0]), b)
    return Multipliers(x, REGULARISATION * x)


def rank(G: ca.SX) -> ca.SX:
    """How many independent rows G (m x 2) has: the eigenvalues of G'G, squares of its singular values, that count."""
    M = G.T @ G
    middle = 0.5 * (M[0, 0] + M[1, 1])
    apart = ca.sqrt((0.5 * (M[0, 0] - M[1, 1])) ** 2 + M[0, 1] ** 2)
    return (middle + apart > INDEPENDENT) + (middle - apart > INDEPENDENT)


def solve(A: ca.SX, b: ca.SX) -> ca.SX:
    """A^-1 b of a symmetric positive definite matrix (m x m) by A = L D L', written out."""
    m = A.shape[0]
    L, d = ca.SX.eye(m), ca.SX.zeros(m)
    x = ca.densify(b)
    for j in range(m):
        d[j] = A[j, j] - sum(L[j, k] ** 2 * d[k] for k in range(j))
        for i in range(j + 1, m):
            L[i, j] = (A[i, j] - sum(L[i, k] * L[j, k] * d[k] for k in range(j))) / d[j]
            x[i] -= L[i, j] * x[j]
    x = x / d
    for j in reversed(range(m)):
        for i in range(j):
            x[i] -= L[j, i] * x[j]
    return x
