"""How far ahead each command is taken: the known delays between the command and the car's answer, added up.

A D/S filter delays by 3/omega, a first-order lag by its time constant, a hold by half its period, and the low level
acts one of its periods later.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Signals
from fmus.controllers.bus import PREVIEW_PERIOD
from fmus.controllers.high_level_lqr.inversion import NODES

REACH = (NODES - 1) * PREVIEW_PERIOD
"""s; the polynomials of the near future reach no further."""


def steering(p: Signals) -> Any:
    """Lead of the feed-forward steering angle [s]."""
    return _within_reach(_filter(p, "steering") + p["actuator.steering.filter_time"] + _sampling(p))


def yaw_rate(p: Signals) -> Any:
    """Lead of the yaw rate [s], which is also the lag of the car's answer to it."""
    return _within_reach(_filter(p, "yaw_rate") + _sampling(p))


def speed(p: Signals) -> Any:
    """Lead of speed and acceleration [s]."""
    return _within_reach(_filter(p, "speed") + _sampling(p))


def _filter(p: Signals, name: str) -> Any:
    return 3 / p[f"actuator.filter.{name}"]


def _sampling(p: Signals) -> Any:
    return p["sample_period"] / 2 + p["actuator.sample_period"]


def _within_reach(lead: Any) -> Any:
    return ca.fmin(lead, REACH)
