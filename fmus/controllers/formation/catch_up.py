"""A follower far from its place does not rush there: the wanted place is brought near it, and led back.

Speed and grip are limited, and a law that is linear in the error overshoots from afar: it asks for the full speed until
the place is reached. When the error is larger than `catch_up.distance` the course of the wanted offset therefore begins
anew, at rest, so near the follower that the error is just that large, and ends at the target as late as gentle
accelerations need.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals, choose
from fmus.controllers.formation import offset

_SHARE = 0.5  # of the acceleration and of the spare speed that leading back may take
_SLOWEST = 1.0  # m/s; at least so fast, also behind a leader at the speed limit or at rest
_SMALLEST = 1e-12


def led_back(p: Signals, course: Parts, away: ca.SX, speed: ca.SX) -> Parts:
    """The state of `offset`, begun anew when the follower is further off than `catch_up.distance`.

    away   from the wanted place to the follower, in the leader's axes [m] (2)
    speed  of the leader, as far as known [m/s]
    """
    distance = ca.fmax(ca.norm_2(away), _SMALLEST)
    beyond = 1 - p["catch_up.distance"] / distance
    begin = offset.value(course)[0] + beyond * away
    still = ca.SX.zeros(2)
    way = course["target"] - begin
    duration = ca.fmax(p["formation.duration"], offset.duration_within(ca.norm_2(way), *gentle(p, speed, way)))
    anew = {"begin": begin, "begin_rate": still, "begin_acceleration": still, "elapsed": 0, "duration": duration}
    return choose(beyond > 0, course | anew, course)


def gentle(p: Signals, speed: ca.SX, way: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(speed [m/s], acceleration [m/s2]) of a place that moves by `way` [m] (2) as seen by a leader at `speed`.

    Half of what is left: forwards up to the limit, backwards down to a standstill.
    """
    acceleration = _SHARE * ca.fmin(p["limit.acceleration"], p["limit.deceleration"])
    left = ca.if_else(way[0] < 0, speed, p["limit.speed"] - speed)
    return ca.fmax(_SHARE * left, _SLOWEST), acceleration
