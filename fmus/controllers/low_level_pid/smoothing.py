"""D/S filter: a third-order state filter that turns a stepwise command into a smooth one with two derivatives."""

from __future__ import annotations

import casadi as ca


def transition(omega: ca.SX, T: ca.SX) -> ca.SX:
    """exp(A T) (3 x 3) of omega^3 / (s + omega)^3 with state (r, r', r'').

    Exact and finite: (A + omega I)^3 = 0, so exp(A T) = exp(-omega T) (I + N T + N^2 T^2 / 2), N = A + omega I.
    """
    A = ca.vertcat(ca.horzcat(0, 1, 0), ca.horzcat(0, 0, 1), ca.horzcat(-(omega**3), -3 * omega**2, -3 * omega))
    N = A + omega * ca.DM.eye(3)
    return ca.exp(-omega * T) * (ca.DM.eye(3) + N * T + (N @ N) * T**2 / 2)


def advance(Phi: ca.SX, state: ca.SX, command: ca.SX) -> ca.SX:
    """State after one period of a held command. The static gain is 1, so the input matrix is (I - Phi) e_1."""
    rest = settled(command)
    return rest + Phi @ (state - rest)


def settled(command: ca.SX) -> ca.SX:
    """State of a filter at rest at `command`."""
    return ca.vertcat(command, 0, 0)
