"""How far ahead each command is taken: the known delays between the command and the car's answer, added up.

A D/S filter delays by 3/omega, a first-order lag by its time constant, a hold by half its period, and the low level
acts one of its periods later.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TypeVar

import casadi as ca

from fmus.controllers.bus import PREVIEW_PERIOD
from fmus.controllers.high_level_lqr.inversion import NODES

Expression = TypeVar("Expression", ca.SX, ca.MX)
Get = Callable[[str], Expression]
"""Gives a parameter by name."""
REACH = (NODES - 1) * PREVIEW_PERIOD
"""s; the polynomials of the near future reach no further."""


def steering(get: Get[Expression]) -> Expression:
    """Lead of the feed-forward steering angle [s]."""
    return _within_reach(_filter(get, "steering") + get("actuator.steering.filter_time") + _sampling(get))


def yaw_rate(get: Get[Expression]) -> Expression:
    """Lead of the yaw rate [s], which is also the lag of the car's answer to it."""
    return _within_reach(_filter(get, "yaw_rate") + _sampling(get))


def speed(get: Get[Expression]) -> Expression:
    """Lead of speed and acceleration [s]."""
    return _within_reach(_filter(get, "speed") + _sampling(get))


def _filter(get: Get[Expression], name: str) -> Expression:
    return 3 / get(f"actuator.filter.{name}")


def _sampling(get: Get[Expression]) -> Expression:
    return get("sample_period") / 2 + get("actuator.sample_period")


def _within_reach(lead: Expression) -> Expression:
    return ca.fmin(lead, REACH)
