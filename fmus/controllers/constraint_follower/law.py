"""The constraints of one follower: q its hand and yaw angle, s what moves by itself, leader and trajectory.

Leader and trajectory are driven coordinates: the follower moves itself only, whatever its constraints ask for.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Signals
from fmus.cars.rotation import rotation_plane
from fmus.controllers.constraint_follower import constraints
from fmus.controllers.constraint_follower.interface import KINDS
from fmus.controllers.formation import hand
from fmus.controllers.formation.moving import MovingPlace

_ROWS_OF = {"offset": 2, "distance": 1, "trajectory": 2, "heading": 1}
_SHORTEST = 1.0  # m; shortest distance by which the row of the distance is divided


class Own(NamedTuple):
    """The follower: (h, psi) and its rate (3 each), as measured; velocity (2) and yaw rate its commands stand for."""

    q: ca.SX
    rate: ca.SX
    velocity: ca.SX
    yaw_rate: ca.SX


class Asked(NamedTuple):
    """u = (v', omega') wanted [m/s2, rad/s2]; C and multipliers (6 each), which rows are on (6), and their rank."""

    acceleration: ca.SX
    yaw_acceleration: ca.SX
    C: ca.SX
    multipliers: constraints.Multipliers
    on: ca.SX
    rank: ca.SX


def own(p: Signals, u: Signals, speed: ca.SX, yaw_rate: ca.SX) -> Own:
    """The follower as measured, and with the integrated `speed` and `yaw_rate` in the terms its commands cause."""
    a, yaw, velocity = p["hand.distance"], u["estimate.yaw"], u.vector("estimate.velocity", "xy")
    h = hand.point(u.vector("estimate.position", "xy"), yaw, a)
    h_rate = hand.velocity(velocity, yaw, u["estimate.yaw_rate"], a)
    rate = ca.vertcat(h_rate, u["estimate.yaw_rate"])
    return Own(ca.vertcat(h, yaw), rate, ca.vertcat(speed, velocity[1]), yaw_rate)


def ask(
    p: Signals,
    me: Own,
    leader: MovingPlace,
    place: MovingPlace,
    path: MovingPlace,
    axes: MovingPlace,
    yielding: ca.SX,
    heard: ca.SX,
) -> Asked:
    """The accelerations that the constraints switched on ask for.

    `place` is the wanted offset of O1 (2) in `axes`, a yaw angle (1), with derivatives; those to the leader are off
    while it is not heard. The place moves back by `yielding` more for each m/s2 of v' [1], and its column in W B too.
    """
    a = p["hand.distance"]
    s, ds, dds = (ca.vertcat(*parts) for parts in zip(leader, place, path, axes, strict=True))
    C, W, rate, gamma = follower_rows()(me.q, me.rate, s, ds, dds, a)
    on = switches(p, heard)
    length = _scale(me, leader, place, a)
    scale = on * length
    correction = _within(p["omega_n"] ** 2 * scale * C, p["limit.correction"])
    damping = 2 * p["zeta"] * p["omega_n"]
    n, B = constraints.drift(me.q[2], me.velocity, me.yaw_rate, a), constraints.directions(me.q[2], a)
    tied = ca.sum1(on[:3]) + on[5] > 0
    tau = tied * _along_with(me, leader, n, a, damping)
    still = ca.SX.zeros(s.numel())
    falling = follower_rows()(me.q, ca.SX.zeros(3), s, still, ca.vertcat(still[:3], 1, still[4:]), a)[3]
    G = ca.diag(scale) @ (W @ B - yielding * falling @ ca.SX([[1, 0]]))
    b = scale * (W @ n + gamma + damping * rate) + G @ tau + correction
    found = constraints.multipliers(G, b)
    wanted = tau - G.T @ found.value
    return Asked(wanted[0], wanted[1] / a, length * C, found, on, constraints.rank(G))


def _along_with(me: Own, leader: MovingPlace, n: ca.SX, a: ca.SX, damping: ca.SX) -> ca.SX:
    """tau [m/s2] (2): the hand takes up the motion of the leader's, where constraints to the leader leave it free."""
    ahead = hand.moving(leader, a)
    wanted = ahead.acceleration - damping * (me.rate[:2] - ahead.rate)
    return rotation_plane(me.q[2]).T @ (wanted - n[:2])


def switches(p: Signals, heard: ca.SX) -> ca.SX:
    """Which rows are on (6), 0 or 1."""
    kinds = {kind: p[f"constraint.{kind}"] * (1 if kind == "trajectory" else heard) for kind in KINDS}
    return ca.vertcat(*(kinds[kind] for kind in KINDS for _ in range(_ROWS_OF[kind])))


def error(p: Signals, asked: Asked) -> ca.SX:
    """Actual minus wanted place of the hand [m] (2), world axes: the offset's, of a vehicle without one the path's."""
    return ca.if_else(p["constraint.trajectory"] * (1 - p["constraint.offset"]), asked.C[3:5], asked.C[:2])


def follower_rows() -> ca.Function:
    """(q, q', s, s', s'', a) -> (C, W, C', gamma) of all rows: q (3) and s (9).

    s are the leader's O1 (3), r (2), the path's O1 (3), and the yaw angle of the axes of r (1).
    """
    q, s, a = ca.SX.sym("q", 3), ca.SX.sym("s", 9), ca.SX.sym("a")
    leader, r, path = _hand_of(s[:3], a), s[3:5], _hand_of(s[5:8], a)
    C = ca.vertcat(
        constraints.offset(q, ca.vertcat(leader[:2], s[8]), r),
        constraints.distance(q, leader, r),
        constraints.trajectory(q, path),
        constraints.heading(q, leader),
    )
    return constraints.rows(C, q, s, a)


def _hand_of(place: ca.SX, a: ca.SX) -> ca.SX:
    """(h, psi) of a vehicle whose O1 and yaw angle are `place` (3)."""
    return ca.vertcat(hand.point(place[:2], place[2], a), place[2])


def _scale(me: Own, leader: MovingPlace, place: MovingPlace, a: ca.SX) -> ca.SX:
    """Factors (6) that bring all rows to metres: lengths of G are then about one."""
    apart = ca.norm_2(me.q[:2] - _hand_of(leader.place, a)[:2])
    length = ca.fmax(ca.fmax(apart, ca.norm_2(place.place)), _SHORTEST)
    return ca.vertcat(1, 1, 1 / length, 1, 1, a)


def _within(correction: ca.SX, limit: ca.SX) -> ca.SX:
    """K_p C, each constraint shortened to at most `limit`, its direction kept."""
    parts, start = [], 0
    for kind in KINDS:
        part = correction[start : start + _ROWS_OF[kind]]
        parts.append(part * limit / ca.fmax(limit, ca.norm_2(part)))
        start += _ROWS_OF[kind]
    return ca.vertcat(*parts)
