"""Backward Riccati recursion of the finite-horizon linear quadratic problem."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import block
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD
from fmus.controllers.high_level_lqr.tracking import exact_model

_N = 4
_TERMINAL_STEPS = 2000


@block(S=10, weights=6, v=1, curvature=1, reach=1)
def step(S: ca.SX, weights: ca.SX, v: ca.SX, curvature: ca.SX, reach: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(S one step of PREVIEW_PERIOD earlier, packed; gain K as a column of 8) from S packed by `pack`.

    K = (B'SB + R)^-1 B'SA, S <- Q + A'S(A - BK); weights are the diagonals of Q (4) and R (2).
    """
    Q, R = ca.diag(weights[:4]), ca.diag(weights[4:])
    A, B = exact_model(v, curvature, PREVIEW_PERIOD, reach)
    full = unpack(S)
    SB = full @ B
    K = _inverse(B.T @ SB + R) @ (SB.T @ A)
    return pack(Q + A.T @ full @ (A - B @ K)), ca.vec(K)


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


@block(symbol=ca.MX, weights=6, v=1, reach=1)
def terminal(weights: ca.MX, v: ca.MX, reach: ca.MX) -> ca.MX:
    """The packed solution of the discrete algebraic Riccati equation at constant v [m/s] on a straight.

    The recursion runs to its limit from S = Q.
    """
    held = ca.repmat(ca.vertcat(weights, v, reach), 1, _TERMINAL_STEPS)
    return _on_a_straight.function.fold(_TERMINAL_STEPS)(_start(weights), held)


@block(weights=6)
def _start(weights: ca.SX) -> ca.SX:
    return pack(ca.diag(weights[:4]))


@block(S=10, held=8)
def _on_a_straight(S: ca.SX, held: ca.SX) -> ca.SX:
    return step(S, held[:6], held[6], 0, held[7])[0]


@block(symbol=ca.MX, S=10, weights=6, v=(1, PREVIEW), curvature=(1, PREVIEW), reach=(1, PREVIEW))
def first_gain(S: ca.MX, weights: ca.MX, v: ca.MX, curvature: ca.MX, reach: ca.MX) -> ca.MX:
    """The first gain K (2 x 4) from the packed terminal weight S, over the steps of the preview."""
    last = ca.vertcat(S, ca.MX.zeros(8))
    backward = ca.vertcat(v, curvature, reach)[:, ::-1]
    end = _backward.function.fold(PREVIEW)(last, ca.repmat(weights, 1, PREVIEW), backward)
    return ca.reshape(end[10:], 2, _N)


@block(carried=18, weights=6, at=3)
def _backward(carried: ca.SX, weights: ca.SX, at: ca.SX) -> ca.SX:
    return ca.vertcat(*step(carried[:10], weights, *ca.vertsplit(at)))


def _inverse(M: ca.SX) -> ca.SX:
    """Inverse of a symmetric 2 x 2 matrix."""
    a, b, d = M[0, 0], M[0, 1], M[1, 1]
    return ca.vertcat(ca.horzcat(d, -b), ca.horzcat(-b, a)) / (a * d - b * b)
