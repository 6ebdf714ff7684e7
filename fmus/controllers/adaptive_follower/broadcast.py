"""The speed that the head of the formation tells all: what is known of the leader's velocity without learning it.

Nothing is known before it was heard. What was heard last counts until something newer is, however old it is: a head
that changes its speed unheard is a leader that does, and the network learns the difference.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, choose

STATES = Layout(
    heard=1,  # 1 once the head was heard, else 0
    speed=1,  # last heard [m/s]
)


def follow(p: Signals, u: Signals, before: Parts) -> Parts:
    """The next state; with `feedforward.enabled` off, or the leader's own rates heard, nothing is ever heard."""
    heard = ca.logic_and(p["feedforward.enabled"] * (1 - p["heard_rates"]), u["feedforward.valid"] > 0.5)
    return choose(heard, {"heard": 1, "speed": u["feedforward.speed"]}, before)


def known(state: Parts) -> ca.SX:
    """Velocity of the leader in its body axes as told [m/s] (2), 0 before anything was."""
    speed: ca.SX = state["speed"]
    return ca.vertcat(speed, 0)


def just_told(before: Parts, after: Parts) -> ca.SX:
    """`known` at the sample at which the head is heard for the first time, else 0 [m/s] (2)."""
    return (after["heard"] - before["heard"]) * known(after)
