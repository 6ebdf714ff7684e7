"""The wanted place in the formation, changed smoothly: a quintic from the present (r, r', r'') to a new place at rest.

r and its first two derivatives are continuous (C2) at all times, also when a new target arrives on the way, and the
end is reached exactly after `duration`. A target that moves at every sample is followed too: a quintic begun anew
without end is the filter r''' = (60 (target - r) - 36 T r' - 9 T^2 r'')/T^3, whose poles are stable.
"""

from __future__ import annotations

import math
from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, choose

STATES = Layout(begin=2, begin_rate=2, begin_acceleration=2, target=2, elapsed=1, duration=1)
"""Where the course began [m, m/s, m/s2], where it ends [m], and how long ago it began of how long it lasts [s]."""


def start(target: Any) -> Parts:
    """The state of a vehicle that is wanted at `target` [m] (2), and has been."""
    still = ca.DM.zeros(2)
    course = {"begin": target, "begin_rate": still, "begin_acceleration": still}
    return course | {"target": target, "elapsed": 1.0, "duration": 1.0}


def advance(state: Parts, target: Any, T: Any, duration: Any) -> Parts:
    """The state one period T [s] later; a target (2) other than that of the state begins a new course now."""
    r, rate, acceleration = value(state)
    anew = ca.logic_or(target[0] != state["target"][0], target[1] != state["target"][1])
    course = {"begin": r, "begin_rate": rate, "begin_acceleration": acceleration}
    begun = course | {"target": target, "elapsed": 0, "duration": duration}
    now = choose(anew, begun, state)
    return now | {"elapsed": ca.fmin(now["elapsed"] + T, now["duration"])}


def unhurried(state: Parts, target: Any, duration: Any, speed: Any, acceleration: Any) -> Any:
    """`duration` [s], longer where a course from rest would exceed `speed` [m/s] or `acceleration` [m/s2]."""
    way = ca.norm_2(target - value(state)[0])
    return ca.fmax(duration, duration_within(way, speed, acceleration))


def duration_within(way: Any, speed: Any, acceleration: Any) -> Any:
    """How long [s] a course over `way` [m] from rest to rest takes that just reaches one of the two limits.

    A quintic over d in T reaches 15/8 d/T and 10/sqrt(3) d/T^2.
    """
    return ca.fmax(15 / 8 * way / speed, ca.sqrt(10 / math.sqrt(3) * way / acceleration))


def value(state: Parts) -> tuple[Any, Any, Any]:
    """(r, r', r'') [m, m/s, m/s2] (2 each) now: of the quintic, or of its end, exactly, when that is reached."""
    T, there = state["duration"], state["elapsed"] >= state["duration"]
    tau = state["elapsed"] / T
    v0, a0 = T * state["begin_rate"], T**2 * state["begin_acceleration"]
    way = state["target"] - state["begin"]
    c3 = 10 * way - 6 * v0 - 1.5 * a0
    c4 = -15 * way + 8 * v0 + 1.5 * a0
    c5 = 6 * way - 3 * v0 - 0.5 * a0
    r = state["begin"] + tau * (v0 + tau * (0.5 * a0 + tau * (c3 + tau * (c4 + tau * c5))))
    rate = v0 + tau * (a0 + tau * (3 * c3 + tau * (4 * c4 + tau * 5 * c5)))
    acceleration = a0 + tau * (6 * c3 + tau * (12 * c4 + tau * 20 * c5))
    return (
        ca.if_else(there, state["target"], r),
        ca.if_else(there, 0.0, rate / T),
        ca.if_else(there, 0.0, acceleration / T**2),
    )
