"""Exact zero-order hold of x' = A x + B u + d."""

from __future__ import annotations

import math

import casadi as ca

_TERMS, _HALVINGS = 8, 4


def zero_order_hold(A: ca.SX, T: ca.SX | float) -> tuple[ca.SX, ca.SX]:
    """Phi = exp(A T) and its integral over T, by Taylor series of T/16 and doubling; structural zeros stay zeros.

    The error is below 1e-9 relative for norms of A T up to 4.
    """
    n = A.shape[0]
    h = T / 2**_HALVINGS
    power, Phi, total = ca.SX.eye(n), ca.SX.eye(n), ca.SX.eye(n)
    for k in range(1, _TERMS + 1):
        power = A @ power
        Phi += power * (h**k / math.factorial(k))
        total += power * (h**k / math.factorial(k + 1))
    total *= h
    for _ in range(_HALVINGS):
        total += Phi @ total
        Phi = Phi @ Phi
    return Phi, total
