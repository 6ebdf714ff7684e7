"""The axes in which a place is wanted: those of the leader's body, or those of a rod that trails from its hand.

A rigid frame sweeps a place at r sideways with r omega_L: far behind, nobody can follow that. A rod of length l that is
towed by the leader's hand h_L has its other end move along itself, like the axle of a trailer:

    l = max(|r|, a),   u = R(psi_f)' h_L',   omega_f = psi_f' = u_y/l,   omega_f' = (u_y' - omega_f l')/l
    u' = R(psi_f)' h_L'' - omega_f S u

psi_f follows the way of the hand, not its velocity: towed along a straight piece of length s, the angle phi between
rod and piece becomes tan(phi/2) -> tan(phi/2) exp(-s/l), the tractrix. So no error of a velocity adds up along a rod.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, choose
from fmus.cars.rotation import rotation_plane, wrap
from fmus.clip import clip
from fmus.controllers.formation import hand
from fmus.controllers.formation.moving import MovingPlace

_UNSURE = 0.01  # rad; what a yaw angle may be heard wrong by
STATES = Layout(
    known=1,  # 1 once the leader was heard
    hand=2,  # of the leader when it was heard last, world [m]
    yaw=1,  # psi_f [rad]
)


def towed(yaw: Any, way: Any, length: Any) -> Any:
    """psi_f [rad] once the hand has moved straight on by `way` [m] (2), exactly."""
    course = ca.atan2(way[1], way[0])
    half = 0.5 * wrap(course - yaw)
    left = ca.atan2(ca.exp(-ca.norm_2(way) / length) * ca.sin(half), ca.cos(half))
    return ca.if_else(ca.sumsqr(way) > 0, yaw + 2 * (half - left), yaw)


def rod(place: MovingPlace, a: Any) -> tuple[Any, Any]:
    """Length l = max(|r|, a) [m] of the rod to a place r, and its rate [m/s]."""
    far = ca.norm_2(place.place)
    longer = far > a
    rate = ca.dot(place.place, place.rate) / ca.fmax(far, a)
    return ca.if_else(longer, far, a), ca.if_else(longer, rate, 0)


def follow(p: Signals, u: Signals, before: Parts, leader: MovingPlace, place: MovingPlace, heard: Any) -> Parts:
    """The next state: the rod follows the leader's hand; while that is not heard it waits.

    `leader` is (x, y, psi) of its O1 as it moves now, `place` is r. At the first message the rod lies along the leader,
    and as far as that is not sure, to the own hand: a milliradian heard wrong is half a metre at the end of 50 cars.
    """
    a = p["hand.distance"]
    now = hand.point(leader.place[:2], leader.place[2], a)
    yaw = towed(before["yaw"], now - before["hand"], rod(place, a)[0])
    after = {"known": 1, "hand": now, "yaw": ca.if_else(before["known"], yaw, _first(p, u, leader, place))}
    return choose(heard, after, before)


def _first(p: Signals, u: Signals, leader: MovingPlace, place: MovingPlace) -> Any:
    """psi_f [rad] with which the own hand is nearest to its place, within what the leader's yaw angle may be wrong."""
    a = p["hand.distance"]
    own = hand.point(u.vector("estimate.position", "xy"), u["estimate.yaw"], a)
    seen = rotation_plane(leader.place[2]).T @ (own - hand.point(leader.place[:2], leader.place[2], a))
    r = place.place
    return leader.place[2] + clip(ca.atan2(r[0] * seen[1] - r[1] * seen[0], ca.dot(r, seen)), -_UNSURE, _UNSURE)


def motion(p: Signals, state: Parts, leader: MovingPlace, place: MovingPlace) -> MovingPlace:
    """(psi_f, omega_f, omega_f') of the rod, or without `frame.trailing` those of the leader's yaw angle."""
    a = p["hand.distance"]
    length, growing = rod(place, a)
    point = hand.moving(leader, a)
    R = rotation_plane(state["yaw"])
    u = R.T @ point.rate
    turning = u[1] / length
    changing = R.T @ point.acceleration - turning * hand.S @ u
    trailing = MovingPlace(state["yaw"], turning, (changing[1] - turning * growing) / length)
    body = (part[2] for part in leader)
    return MovingPlace(*(ca.if_else(p["frame.trailing"], *pair) for pair in zip(trailing, body, strict=True)))


def wanted_hand(leader: MovingPlace, axes: MovingPlace, place: MovingPlace, a: Any) -> MovingPlace:
    """h_d = h_L + R(psi_f) r (2) with its derivatives: where the follower's hand is wanted, and how that moves."""
    point, R, S = hand.moving(leader, a), rotation_plane(axes.place), hand.S
    r, rate, acceleration = place
    w, dw = axes.rate, axes.acceleration
    return MovingPlace(
        point.place + R @ r,
        point.rate + R @ (rate + w * S @ r),
        point.acceleration + R @ (acceleration + 2 * w * S @ rate + dw * S @ r - w**2 * r),
    )
