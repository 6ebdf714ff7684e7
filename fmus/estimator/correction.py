"""The two updates of a fix, in Joseph form, each stage correcting only its own states."""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, block
from fmus.cars.rotation import rotation_plane, wrap
from fmus.estimator.navigation import BELIEF, PACKED, STAGE_1, STAGE_2, STATE, full, pack, quarter_turn

FIX = Layout(position=2, velocity=2, heading=1)
LEVER = Layout(offset=2, velocity=2)
"""Antenna relative to the inertial unit, level frame: offset [m] and velocity [m/s] (gyroscope bias not removed)."""
TRUST = Layout(position=1, velocity=1, heading=1, gate_heading=1, gate_position=1, patience=1)
"""Variances of the fix, gates on the normalised innovation squared, refused fixes in a row before doubting."""


@block(belief=BELIEF, fix=FIX, lever=LEVER, trust=TRUST, doubt=1, initial=PACKED)
def correct(
    belief: Parts, fix: Parts, lever: Parts, trust: Parts, doubt: ca.SX, initial: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """The belief (column of BELIEF) after a fix, NIS (heading, position), and which of both are accepted.

    With `doubt` = 1 the initial covariance is added first and nothing is refused.
    """
    z, P = belief["mean"], full(belief["covariance"] + doubt * initial)
    z, P, nis_1, accepted_1 = _heading(z, P, fix, trust, doubt)
    z, P, nis_2, accepted_2 = _position(z, P, fix, lever, k=trust, doubt=doubt)
    return ca.vertcat(z, pack(P)), ca.vertcat(nis_1, nis_2), ca.vertcat(accepted_1, accepted_2)


def _heading(z: ca.SX, P: ca.SX, fix: Parts, k: Parts, doubt: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """Stage 1: two-antenna heading, innovation wrapped to (-pi, pi]."""
    H = ca.horzcat(1, ca.SX(1, STATE.size - 1))
    gap = fix["heading"] - z[0]
    return update(z, P, wrap(gap), H, k["heading"], own=STAGE_1, gate=k["gate_heading"], doubt=doubt)


def _position(
    z: ca.SX, P: ca.SX, fix: Parts, lever: Parts, *, k: Parts, doubt: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """Stage 2: antenna position p + Rz(psi) l + c and velocity Rz(psi)(w + l'); psi's uncertainty is considered."""
    states = STATE.symbol("z")
    predicted = antenna(states, lever)
    H = ca.substitute(ca.jacobian(predicted, states), states, z)
    gap = ca.vertcat(fix["position"], fix["velocity"]) - ca.substitute(predicted, states, z)
    R: Any = ca.diag(ca.vertcat(k["position"], k["position"], k["velocity"], k["velocity"]))
    return update(z, P, gap, H, R, own=STAGE_2, gate=k["gate_position"], doubt=doubt)


def antenna(z: ca.SX, lever: Parts) -> ca.SX:
    """Predicted position and velocity of the antenna (4)."""
    s, l = STATE.split(z), lever  # noqa: E741 (the book's lever arm)
    Rz = rotation_plane(s["heading"])
    velocity = s["velocity"] + l["velocity"] - s["gyroscope_bias"] * quarter_turn(l["offset"])
    return ca.vertcat(s["position"] + Rz @ l["offset"] + s["gps_error"], Rz @ velocity)


def update(
    z: ca.SX, P: ca.SX, gap: ca.SX, H: ca.SX, R: ca.SX, *, own: slice, gate: ca.SX, doubt: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX]:
    """Schmidt-Kalman update of the states `own`: the gain's other rows are 0 but their covariance counts in S.

    Returns mean, covariance, NIS and 1 if accepted. A refused innovation gets the gain 0, which the Joseph form
    P+ = (I - K H) P (I - K H)' + K R K' turns into P+ = P.
    """
    L = ca.chol(H @ P @ H.T + R).T
    white = ca.solve(L, gap)
    nis = ca.sumsqr(white)
    accepted = ca.logic_or(nis <= gate, doubt > 0.5)
    full = ca.solve(L.T, ca.solve(L, H @ P)).T
    K = ca.SX(STATE.size, H.shape[0])
    K[own, :] = accepted * full[own, :]
    return z + K @ gap, joseph(P, K, H, R), nis, accepted


def joseph(P: ca.SX, K: ca.SX, H: ca.SX, R: ca.SX) -> ca.SX:
    """(I - K H) P (I - K H)' + K R K': symmetric and positive semidefinite for any gain."""
    rest = ca.SX.eye(P.shape[0]) - K @ H
    return rest @ P @ rest.T + K @ R @ K.T
