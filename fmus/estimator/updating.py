"""Kalman updates of a belief: one measurement at a time, gated, in Joseph form."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Parts
from fmus.estimator.navigation import STATE, full, pack

OPEN = 1e12
"""A gate that refuses nothing."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """Of one measurement: its normalised innovation squared, and 1 where it was accepted."""

    nis: ca.SX
    accepted: ca.SX


class Estimate:
    """Mean z and covariance P while measurements come in one after another."""

    def __init__(self, belief: Parts) -> None:
        self.z, self.P = belief["mean"], full(belief["covariance"])

    def seen(self) -> Parts:
        """The parts of the mean."""
        parts: Parts = STATE.split(self.z)
        return parts

    def column(self) -> ca.SX:
        """The belief as a column of BELIEF."""
        return ca.vertcat(self.z, pack(self.P))

    def widen(self, by: ca.SX) -> None:
        """Add a covariance (packed)."""
        self.P = self.P + full(by)

    def take(self, gap: ca.SX, H: ca.SX, R: ca.SX, *, gate: ca.SX, used: ca.SX) -> Outcome:
        """Kalman update with the innovation `gap`, refused above `gate`; nothing changes where `used` is 0."""
        nis, accepted, K, S = _gain(self.P, gap, H, R, gate)
        K = K * used * accepted
        self.z, self.P = self.z + K @ gap, joseph(self.P, K, H, S)
        return Outcome(nis, accepted)


def linear(predicted: ca.SX, states: ca.SX, z: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The measurement `predicted` (an expression of `states`) at z, and its Jacobian there."""
    H = ca.jacobian(predicted, states)
    value, slope = ca.substitute([predicted, H], [states], [z])
    return value, slope


def joseph(P: ca.SX, K: ca.SX, H: ca.SX, S: ca.SX) -> ca.SX:
    """(I - K H) P (I - K H)' + K R K' multiplied out, with S = H P H' + R: symmetric for any gain."""
    KHP = K @ (H @ P)
    return P - KHP - KHP.T + K @ S @ K.T


def _gain(P: ca.SX, gap: ca.SX, H: ca.SX, R: ca.SX, gate: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """NIS, 1 if it is within the gate, the gain and S of a measurement."""
    S = H @ P @ H.T + R
    L = ca.chol(S).T
    nis = ca.sumsqr(ca.solve(L, gap))
    K = ca.solve(L.T, ca.solve(L, H @ P)).T
    return nis, nis <= gate, K, S
