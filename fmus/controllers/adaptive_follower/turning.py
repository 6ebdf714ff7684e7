"""How fast the leader turns, from one message to the next: messages carry its yaw angle, not its yaw rate."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, choose
from fmus.cars.rotation import wrap
from fmus.clip import clip
from fmus.controllers.formation.messages import news

STATES = Layout(
    known=1,  # 1 once there was a message
    age=1,  # of the newest message at the last sample [s]
    yaw=1,  # in the newest message [rad]
    rate=1,  # yaw rate of the leader [rad/s]
)
_FASTEST = 1.5  # rad/s; no car turns faster


def follow(p: Signals, u: Signals, before: Parts, heard: ca.SX) -> Parts:
    """The next state: at a new message the rate moves towards the change of yaw over the time between the two."""
    new, between = news(heard, before["age"], u["leader.age"], p["sample_period"])
    seen = clip(wrap(u["leader.yaw"] - before["yaw"]) / between, -_FASTEST, _FASTEST)
    share = 1 - ca.exp(-between / p["turning.memory"])
    learnt = before["rate"] + before["known"] * share * (seen - before["rate"])
    age = ca.if_else(heard, u["leader.age"], before["age"] + p["sample_period"])
    told = {"known": 1, "yaw": u["leader.yaw"], "rate": learnt}
    return choose(new, told, before) | {"age": age}
