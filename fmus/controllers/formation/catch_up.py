"""A follower far from its place does not rush there: the wanted place is brought near it, and led back.

Speed and grip are limited, and a law that is linear in the error overshoots from afar: it asks for the full speed until
the place is reached. When the error is larger than `catch_up.distance` the course of the wanted offset therefore begins
anew, at rest, so near the follower that the error is just that large, and ends at the target as late as gentle
accelerations need.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals
from fmus.controllers.formation import offset

_SHARE = 0.5  # of the acceleration and of the spare speed that leading back may take
_SLOWEST = 1.0  # m/s; a leader at the speed limit is caught up with at least so fast
_PEAK_SPEED, _PEAK_ACCELERATION = 1.875, 5.774
"""Of the quintic between two places at rest, over T: way/T, way/T^2."""
_SMALLEST = 1e-12


def led_back(p: Signals, state: ca.SX, away: ca.SX, speed: ca.SX) -> ca.SX:
    """The state of `offset`, begun anew when the follower is further off than `catch_up.distance`.

    away   from the wanted place to the follower, in the leader's axes [m] (2)
    speed  of the leader, as far as known [m/s]
    """
    course = offset.STATES.split(state)
    distance = ca.fmax(ca.norm_2(away), _SMALLEST)
    beyond = 1 - p["catch_up.distance"] / distance
    begin = offset.value(state)[0] + beyond * away
    at_rest = {"begin_rate": ca.SX.zeros(2), "begin_acceleration": ca.SX.zeros(2), "elapsed": ca.SX(0)}
    duration = _duration(p, ca.norm_2(course["target"] - begin), speed)
    anew = offset.STATES.join(course | at_rest | {"begin": begin, "duration": duration})
    return ca.if_else(beyond > 0, anew, state)


def _duration(p: Signals, way: ca.SX, speed: ca.SX) -> ca.SX:
    """Long enough [s] for half of the limits."""
    a = _SHARE * ca.fmin(p["limit.acceleration"], p["limit.deceleration"])
    spare = ca.fmax(_SHARE * (p["limit.speed"] - speed), _SLOWEST)
    needed = ca.fmax(_PEAK_SPEED * way / spare, ca.sqrt(_PEAK_ACCELERATION * way / a))
    return ca.fmax(p["formation.duration"], needed)
