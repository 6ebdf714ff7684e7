"""Backward Riccati recursion of the finite-horizon linear quadratic problem."""

from __future__ import annotations

import casadi as ca

from fmus.controllers.high_level_lqr.tracking import exact_model

_N = 4
_TERMINAL_STEPS = 2000


def step(T: float) -> ca.Function:
    """(S packed, weights, v, curvature, reach) -> (S one step earlier, packed; gain K as a column of 8).

    K = (B'SB + R)^-1 B'SA, S <- Q + A'S(A - BK); weights are the diagonals of Q (4) and R (2). Packed: `pack`.
    """
    packed, weights = ca.SX.sym("S", 10), ca.SX.sym("weights", 6)
    v, curvature, reach = ca.SX.sym("v"), ca.SX.sym("kappa"), ca.SX.sym("reach")
    Q, R = ca.diag(weights[:4]), ca.diag(weights[4:])
    A, B = exact_model(v, curvature, T, reach)
    S = unpack(packed)
    SB = S @ B
    K = _inverse(B.T @ SB + R) @ (SB.T @ A)
    earlier = Q + A.T @ S @ (A - B @ K)
    return ca.Function("riccati", [packed, weights, v, curvature, reach], [pack(earlier), ca.vec(K)])


def pack(S: ca.SX) -> ca.SX:
    """The upper triangle (10) of a symmetric matrix (4 x 4); keeping only it keeps the recursion symmetric."""
    return ca.vertcat(*(0.5 * (S[i, j] + S[j, i]) for i in range(_N) for j in range(i, _N)))


def unpack(packed: ca.SX) -> ca.SX:
    """The symmetric matrix (4 x 4) of its upper triangle."""
    S, k = ca.SX.zeros(_N, _N), 0
    for i in range(_N):
        for j in range(i, _N):
            S[i, j] = S[j, i] = packed[k]
            k += 1
    return S


def terminal(T: float) -> ca.Function:
    """(weights, v, reach) -> packed solution of the discrete algebraic Riccati equation at constant v on a straight.

    The recursion runs to its limit from S = Q.
    """
    weights, v, reach = ca.SX.sym("weights", 6), ca.SX.sym("v"), ca.SX.sym("reach")
    S, column = ca.SX.sym("S", 10), ca.vertcat(weights, v, reach)
    once = ca.Function("once", [S, column], [step(T)(S, weights, v, 0, reach)[0]])
    start = ca.Function("start", [column], [pack(ca.diag(weights[:4]))])
    given = ca.MX.sym("given", 8)
    limit = once.fold(_TERMINAL_STEPS)(start(given), ca.repmat(given, 1, _TERMINAL_STEPS))
    return ca.Function("terminal", [given], [limit])


def first_gain(T: float, steps: int) -> ca.Function:
    """(packed terminal weight, weights, v, curvature, reach (1 x steps each)) -> the first gain K (2 x 4)."""
    S, weights = ca.MX.sym("S", 10), ca.MX.sym("weights", 6)
    v, curvature, reach = (ca.MX.sym(name, 1, steps) for name in ("v", "kappa", "reach"))
    carried, w, at = ca.SX.sym("carried", 18), ca.SX.sym("weights", 6), ca.SX.sym("at", 3)
    body = ca.Function("body", [carried, w, at], [ca.vertcat(*step(T)(carried[:10], w, at[0], at[1], at[2]))])
    last = ca.vertcat(S, ca.MX.zeros(8))
    backward = ca.vertcat(v, curvature, reach)[:, ::-1]
    end = body.fold(steps)(last, ca.repmat(weights, 1, steps), backward)
    return ca.Function("first_gain", [S, weights, v, curvature, reach], [ca.reshape(end[10:], 2, _N)])


def _inverse(M: ca.SX) -> ca.SX:
    """Inverse of a symmetric 2 x 2 matrix."""
    a, b, d = M[0, 0], M[0, 1], M[1, 1]
    return ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-b, a)) / (a * d - b * b)
