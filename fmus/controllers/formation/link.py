"""Supervision of the link to the leader: whether it is heard, and what a follower does while it is not.

A follower that has not heard its leader for longer than `link.patience` drives on straight at the leader's last known
speed for `link.hold`, then brakes with `link.deceleration` to a stop. When messages come again the law takes over
from the commands as they then are.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, choose
from fmus.clip import clip
from fmus.controllers.formation import realise

STATES = Layout(
    silent=1,  # how long the leader has been lost [s]; 0 while it is heard
    known=1,  # its last known speed [m/s]
)


class Link(NamedTuple):
    """1 while the leader is heard, else 0, and the next state."""

    heard: ca.SX
    state: Parts


def supervise(p: Signals, u: Signals, before: Parts, speed: ca.SX) -> Link:
    """The link now; `speed` [m/s] is what is known of the leader while it is heard."""
    heard = ca.logic_and(u["leader.valid"] > 0.5, u["leader.age"] <= p["link.patience"])
    lost = {"silent": before["silent"] + p["sample_period"], "known": before["known"]}
    return Link(heard, choose(heard, {"silent": 0, "known": speed}, lost))


def start(speed: ca.SX) -> Parts:
    """The state before the first message: what is known is the own speed."""
    return {"silent": ca.SX(0), "known": speed}


def hold_speed(p: Signals, now: Parts, last: ca.SX, time: ca.SX) -> realise.Realised:
    """Command.speed [m/s] without a leader, after `last`; `now` is the state of `supervise`, `time` as in `realise`."""
    on = realise.speed_towards(p, last, now["known"], time)
    gently = clip(on.rate, -p["link.deceleration"], p["link.deceleration"])
    braking = now["silent"] > p["link.hold"]
    return realise.speed_at_rate(p, last, ca.if_else(braking, -p["link.deceleration"], gently))
