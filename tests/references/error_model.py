"""The tracking errors of HighLevelLqr in continuous time."""

from __future__ import annotations

import casadi as ca


def continuous_model(v: ca.SX, curvature: ca.SX) -> tuple[ca.SX, ca.SX]:
    """A (4 x 4), B (4 x 2) of e_s' = e_v + w e_n, e_v' = da, e_n' = -w e_s + v e_psi, e_psi' = dw with w = v kappa."""
    w = v * curvature
    A = ca.SX.zeros(4, 4)
    A[0, 1], A[0, 2], A[2, 0], A[2, 3] = 1, w, -w, v
    B = ca.SX.zeros(4, 2)
    B[1, 0], B[3, 1] = 1, 1
    return A, B
