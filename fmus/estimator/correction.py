"""What a fix corrects: first the heading (stage 1), then position and velocity (stage 2).

The parts of a fix may belong to different instants. Each waits in the row of the history that ends nearest to its own,
and is compared with what the antenna did then.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, block
from fmus.cars.rotation import levelling, rotation_plane, wrap
from fmus.estimator.navigation import BELIEF, STATE, motion, where
from fmus.estimator.records import ASSUMED, ROW, VERDICT
from fmus.estimator.updating import OPEN, Estimate, Outcome, linear
from fmus.estimator.wheels import rear_axle

_LOST = 0.3**2  # rad2, variance of a heading that is not known


@block(belief=BELIEF, verdict=VERDICT, row=ROW, assumed=ASSUMED)
def correct(belief: Parts, verdict: Parts, row: Parts, assumed: Parts) -> tuple[ca.SX, Parts]:
    """The belief (column of BELIEF) after the parts of fixes in one row, and the verdicts on them.

    With `doubt` = 1 the initial covariance is added first and nothing is refused.
    """
    e, unit, place, drift = Estimate(belief), row["sensed"]["unit"], row["place"], row["drift"]
    e.widen(row["doubt"] * assumed["initial"])
    gates = {name: ca.if_else(row["doubt"] > 0.5, OPEN, gate) for name, gate in assumed["gates"].items()}
    heading = _heading(e, unit, place, gates["heading"])
    position = _position(e, unit, place, assumed["arms"]["antenna"], gates["position"])
    _align(e, drift, assumed["course"])
    _slow_down(e, drift)
    _go_straight(e, unit, drift, assumed["course"], assumed["arms"]["rear"])
    velocity = _velocity(e, unit, drift, assumed["arms"]["antenna"], gates["velocity"])
    there = ca.vertcat(place["heading_variance"], place["position_variance"], drift["velocity_variance"]) > 0
    outcomes = (heading, position, velocity)
    new = {name: ca.vertcat(*(getattr(outcome, name) for outcome in outcomes)) for name in ("nis", "accepted")}
    return e.column(), {name: ca.if_else(there, new[name], verdict[name]) for name in new}


def _heading(e: Estimate, unit: Parts, fix: Parts, gate: ca.SX) -> Outcome:
    """Stage 1: two-antenna heading, innovation wrapped to (-pi, pi]."""
    s = e.seen()
    expected = s["heading"] - fix["place_delay"] * motion(s, unit)[0][2]
    H = ca.SX(1, STATE.size)
    H[0, where("heading")] = 1
    R = _something(fix["heading_variance"])
    return e.take(wrap(fix["heading"] - expected), H, R, gate=gate, used=fix["heading_variance"] > 0)


def _position(e: Estimate, unit: Parts, fix: Parts, arm: ca.SX, gate: ca.SX) -> Outcome:
    """Position of the antenna."""
    states = STATE.symbol("z")
    place, velocity = antenna(states, unit, arm)
    expected, H = linear(place - fix["place_delay"] * velocity, states, e.z)
    variance = fix["position_variance"]
    R = ca.diag(ca.repmat(_something(variance), 2))
    return e.take(fix["position"] - expected, H, R, gate=gate, used=variance > 0)


def _velocity(e: Estimate, unit: Parts, fix: Parts, arm: ca.SX, gate: ca.SX) -> Outcome:
    """Velocity of the antenna; not used while the heading is not known."""
    states, variance = STATE.symbol("z"), fix["velocity_variance"]
    s = STATE.split(states)
    _, a = motion(s, unit)
    change = rotation_plane(s["heading"]) @ a
    expected, H = linear(antenna(states, unit, arm)[1] - fix["drift_delay"] * change, states, e.z)
    R = ca.diag(ca.repmat(_something(variance), 2))
    known = e.P[0, 0] < _LOST
    return e.take(fix["velocity"] - expected, H, R, gate=gate, used=ca.logic_and(variance > 0, known))


def _align(e: Estimate, fix: Parts, course: Parts) -> None:
    """While the heading is not known, the course of a car that moves is taken for it."""
    speed = ca.norm_2(fix["velocity"] + 1e-9)
    told = ca.logic_and(fix["alone"] > 0.5, speed > course["speed"])
    H = ca.SX(1, STATE.size)
    H[0, where("heading")] = 1
    gap = wrap(ca.atan2(fix["velocity"][1], fix["velocity"][0] + 1e-12) - e.seen()["heading"])
    R = 2 * fix["velocity_variance"] / speed**2 + 4 * course["sideslip"] + 1e-12
    e.take(gap, H, R, gate=ca.SX(OPEN), used=ca.logic_and(told, e.P[0, 0] > _LOST))


def _slow_down(e: Estimate, fix: Parts) -> None:
    """While the heading is not known, a velocity only tells how fast the car may be, in any direction."""
    H = ca.SX(2, STATE.size)
    for row, index in enumerate(where("velocity")):
        H[row, index] = 1
    R = (fix["velocity_variance"] + ca.sumsqr(fix["velocity"]) + 1e-6) * ca.SX.eye(2)
    told = ca.logic_and(fix["velocity_variance"] > 0, e.P[0, 0] > _LOST)
    e.take(-e.seen()["velocity"], H, R, gate=ca.SX(OPEN), used=told)


def _go_straight(e: Estimate, unit: Parts, fix: Parts, course: Parts, arm: ca.SX) -> None:
    """Course as heading: in straight motion the rear axle does not slip sideways, so what slips is the heading."""
    states = STATE.symbol("z")
    expected, H = linear(rear_axle(states, unit, arm)[1], states, e.z)
    s = e.seen()
    rates, a = motion(s, unit)
    speed = ca.fabs(s["velocity"][0])
    slow = ca.logic_or(speed < course["speed"], ca.fabs(rates[2]) > course["rate"])
    told = ca.logic_and(
        fix["alone"] * course["used"] > 0.5, ca.logic_not(ca.logic_or(slow, ca.fabs(a[1]) > course["force"]))
    )
    R = course["sideslip"] * speed**2 + 1e-6
    e.take(-expected, H, R, gate=ca.SX(OPEN), used=ca.logic_and(told, e.P[0, 0] < _LOST))


def antenna(z: ca.SX, unit: Parts, arm: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Predicted position, with the receiver's slow error, and velocity of the antenna (2 each), world frame."""
    s = STATE.split(z)
    C, Rz = levelling(s["tilt"][0], s["tilt"][1]), rotation_plane(s["heading"])
    place = s["position"] + Rz @ (C @ arm)[0:2] + s["gps_error"]
    return place, Rz @ _carried(s, unit, arm, C)


def _carried(s: Parts, unit: Parts, arm: ca.SX, C: ca.SX) -> ca.SX:
    """Velocity in the level frame of a point of the body."""
    return s["velocity"] + (C @ ca.cross(unit["rate"] - s["gyroscope_bias"], arm))[0:2]


def _something(variance: ca.SX) -> ca.SX:
    """The variance, or 1 where there is none: it must not vanish even where nothing is used."""
    return ca.if_else(variance > 0, variance, 1)
