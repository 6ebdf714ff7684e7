"""Where the follower is wanted: the place in the leader's axes, and the trajectory as a vehicle that drives it."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals
from fmus.controllers.formation import offset
from fmus.controllers.formation.hand import S
from fmus.controllers.formation.moving import MovingPlace

HEADWAY = Layout(
    back=1,  # how far the place has moved back [m]
    rate=1,  # how fast it does [m/s]
)
PATH = Layout(
    turning=1,  # rate of the course at the last sample [rad/s]
    sideslip=1,  # slow part of the own sideslip [rad]
)
_SLOW = 3.0  # m/s; below it sideslip is not an angle worth following


def place(shift: Parts, headway: Parts, back_acceleration: ca.SX) -> MovingPlace:
    """The wanted offset of O1 (2) with derivatives: the quintic, further back by the headway."""
    behind = (headway["back"], headway["rate"], back_acceleration)
    return MovingPlace(*(r - ca.vertcat(b, 0) for r, b in zip(offset.value(shift), behind, strict=True)))


def pulled_back(p: Signals, headway: Parts, speed: ca.SX, acceleration: ca.SX) -> Parts:
    """The headway state one period later by d'' + 2 w d' + w^2 d = w^2 headway v, exact for a steady v'.

    A place that has all its derivatives. With e = d - headway v, for a steady v,
    (e, d') after T = exp(-w T) [1 + w T, T; -w^2 T, 1 - w T] (e, d') before.
    """
    w, T = p["headway.filter"], p["sample_period"]
    end, gained = p["headway"] * speed, p["headway"] * acceleration
    e, rate, decay = headway["back"] - end, headway["rate"], ca.exp(-w * T)
    back = end + decay * ((1 + w * T) * e + T * rate) + gained * (T * (1 + decay) - 2 / w * (1 - decay))
    return {"back": back, "rate": decay * ((1 - w * T) * rate - w**2 * T * e) + gained * _share(p)}


def acceleration(p: Signals, headway: Parts, speed: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(mean d'' [m/s2] of the period that begins at a steady v, what each m/s2 of v' adds to it)."""
    later = pulled_back(p, headway, speed, ca.SX(0))
    T = p["sample_period"]
    return (later["rate"] - headway["rate"]) / T, p["headway"] * _share(p) / T


def _share(p: Signals) -> ca.SX:
    """Of a step the double pole w lets through after a period."""
    w, T = p["headway.filter"], p["sample_period"]
    return 1 - (1 + w * T) * ca.exp(-w * T)


def path(p: Signals, u: Signals, before: Parts) -> MovingPlace:
    """The trajectory as O1 of a vehicle: its yaw angle is the course less the own sideslip."""
    v, course = u["reference.speed"], u["reference.course"]
    turning = v * u["reference.curvature"]
    along = ca.vertcat(ca.cos(course), ca.sin(course))
    across = S @ along
    turning_rate = (turning - before["turning"]) / p["sample_period"]
    return MovingPlace(
        ca.vertcat(u["reference.x"], u["reference.y"], course - before["sideslip"]),
        ca.vertcat(v * along, turning),
        ca.vertcat(u["reference.acceleration"] * along + v * turning * across, turning_rate),
    )


def path_state(p: Signals, u: Signals, before: Parts) -> Parts:
    """The state one sample later."""
    velocity = u.vector("estimate.velocity", "xy")
    beta = ca.if_else(velocity[0] > _SLOW, ca.atan2(velocity[1], ca.fmax(velocity[0], _SLOW)), 0)
    share = 1 - ca.exp(-p["sample_period"] / p["sideslip_time"])
    learnt = before["sideslip"] + share * (beta - before["sideslip"])
    return {"turning": u["reference.speed"] * u["reference.curvature"], "sideslip": learnt}


def path_start(u: Signals) -> Parts:
    """The state before the first sample: the course turns steadily."""
    return {"turning": u["reference.speed"] * u["reference.curvature"], "sideslip": ca.SX(0)}
