"""How the leader moves now, from its messages: pose, velocity and yaw rate as sent, accelerations by a filter.

Body velocity, yaw rate and what the head broadcasts, w = (v_x, v_y, omega, v_head), are followed by polynomials of
second degree whose past is forgotten exponentially. The critically damped filter that fits them corrects (w, w', w'')
at a message, Delta after the one before, by its innovation times

    g = 1 - theta^3,   h = 3/2 (1 - theta)^2 (1 + theta)/Delta,   k = (1 - theta)^3/Delta^2,   theta = exp(-Delta/tau)

Between messages all is carried forward, and a message is carried over its age before it is compared. The broadcast of
the head is taken to be as old as the message; until the first one, and while there is none, v_x stands in for v_head.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, choose
from fmus.cars.rotation import rotation_plane, wrap
from fmus.controllers.formation.hand import S
from fmus.controllers.formation.messages import news
from fmus.controllers.formation.moving import MovingPlace

STATES = Layout(
    heard=1,  # 1 while the link stands
    told=1,  # 1 while the head's broadcast counts
    age=1,  # of the newest message [s]
    position=2,  # of O1 [m]
    yaw=1,  # [rad]
    w=4,  # (v_x, v_y, omega, broadcast speed of the head) [m/s, m/s, rad/s, m/s]
    rate=4,  # w'
    curve=4,  # w''
)


def follow(p: Signals, u: Signals, before: Parts, heard: ca.SX) -> Parts:
    """The state now, from that of the sample before; the first message of a link begins anew."""
    T, tau = p["sample_period"], p["leader.filter_time"]
    told = u["feedforward.valid"] > 0.5
    now = carried(before, T, ca.fmax(0, ca.fmin(T, tau - before["age"])))
    new, between = news(heard, before["age"], u["leader.age"], T)
    followed = choose(new, _corrected(u, now, between, tau), now)
    later = choose(ca.logic_and(heard, before["heard"] < 0.5), _begun(u), followed)
    later |= _head_begun(u, later, ca.logic_and(told, before["told"] < 0.5))
    age = ca.if_else(heard, u["leader.age"], before["age"] + T)
    return later | {"heard": ca.if_else(heard, 1, 0), "told": told, "age": age}


def carried(m: Parts, T: ca.SX, bent: ca.SX | None = None) -> Parts:
    """The motion T [s] later; w'' acts for `bent` [s] of it, because a parabola is no forecast for long."""
    D = T if bent is None else bent
    w = m["w"] + T * m["rate"] + D * (T - 0.5 * D) * m["curve"]
    mean = m["w"] + T / 2 * m["rate"] + D**2 / 6 * m["curve"]
    moved = T * (rotation_plane(m["yaw"] + 0.5 * T * mean[2]) @ mean[:2])
    rate = m["rate"] + D * m["curve"]
    return m | {"position": m["position"] + moved, "yaw": m["yaw"] + T * mean[2], "w": w, "rate": rate}


def gains(between: ca.SX, tau: ca.SX) -> ca.SX:
    """(g [1], h [1/s], k [1/s2]) of the critically damped filter for values `between` [s] apart."""
    theta = ca.exp(-between / tau)
    rate = 1.5 * (1 - theta) ** 2 * (1 + theta) / between
    return ca.vertcat(1 - theta**3, rate, ((1 - theta) / between) ** 2 * (1 - theta))


def rates(p: Signals, m: Parts) -> ca.SX:
    """(v_x', v_y', omega') (3); with feedforward.enabled the leader speeds up as the head that is heard does."""
    with_head = ca.logic_and(p["feedforward.enabled"], m["told"])
    return ca.vertcat(ca.if_else(with_head, m["rate"][3], m["rate"][0]), m["rate"][1:3])


def motion(p: Signals, m: Parts) -> MovingPlace:
    """Motion of O1: p' = R v, p'' = R (v' + omega S v), v in body axes."""
    rate = rates(p, m)
    R, v, omega = rotation_plane(m["yaw"]), m["w"][:2], m["w"][2]
    place: Any = ca.vertcat(m["position"], m["yaw"])
    return MovingPlace(
        place,
        ca.vertcat(R @ v, omega),
        ca.vertcat(R @ (rate[:2] + omega * S @ v), rate[2]),
    )


def _message(u: Signals) -> Parts:
    """What the newest message says, at the time it was sent."""
    return {
        "position": u.vector("leader.position", "xy"),
        "yaw": u["leader.yaw"],
        "w": ca.vertcat(u.vector("leader.velocity", "xy"), u["leader.yaw_rate"], u["feedforward.speed"]),
    }


def _head_begun(u: Signals, m: Parts, anew: ca.SX) -> Parts:
    """The polynomials, that of the head begun `anew` from what it told, as if it sped up as the leader does."""
    rate, curve = m["rate"][0], m["curve"][0]
    age = u["leader.age"]
    begun = {"w": u["feedforward.speed"] + age * (rate - age / 2 * curve), "rate": rate, "curve": curve}
    return {name: ca.vertcat(m[name][:3], ca.if_else(anew, value, m[name][3])) for name, value in begun.items()}


def _begun(u: Signals) -> Parts:
    steady = {"rate": ca.SX.zeros(4), "curve": ca.SX.zeros(4)}
    return carried(_message(u) | steady, u["leader.age"])


def _corrected(u: Signals, now: Parts, between: ca.SX, tau: ca.SX) -> Parts:
    """The motion now after a message, `between` [s] after the last."""
    age = u["leader.age"]
    then = now["rate"] - age * now["curve"]
    seen = carried(_message(u) | {"rate": then, "curve": now["curve"]}, age)
    theta, (g, h, k) = ca.exp(-between / tau), ca.vertsplit(gains(between, tau))
    new = seen["w"] - now["w"]
    return {
        "position": now["position"] + (1 - theta) * (seen["position"] - now["position"]),
        "yaw": now["yaw"] + (1 - theta) * wrap(seen["yaw"] - now["yaw"]),
        "w": now["w"] + g * new,
        "rate": now["rate"] + h * new,
        "curve": now["curve"] + k * new,
    }
