"""Speed of the rear wheels and no sideslip, as a reading of the velocity of the rear axle."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts
from fmus.estimator.navigation import STATE, motion, quarter_turn
from fmus.estimator.updating import Estimate, linear

_GATE = 25.0
"""Of the squared innovation over its variance, two degrees of freedom: passed by chance once in 270 000 readings."""


def rear_axle(z: ca.SX, unit: Parts, arm: ca.SX) -> ca.SX:
    """Velocity of the middle of the rear axle (2) [m/s], level frame; the car is taken not to lift."""
    s = STATE.split(z)
    rates, _ = motion(s, unit)
    return s["velocity"] + rates[2] * quarter_turn(arm[0:2])


def roll(e: Estimate, unit: Parts, speed: ca.SX, rolling: Parts, arm: ca.SX) -> None:
    """Update: the rear axle moves at `speed` [m/s] and sideways by -k a_y speed, what its tyres need to push by a_y.

    All errors are shares of the speed, read or expected, but for a floor: wheels that lock tell nothing.
    """
    states = STATE.symbol("z")
    expected, H = linear(rear_axle(states, unit, arm), states, e.z)
    _, a = motion(e.seen(), unit)
    slip = rolling["compliance"] * a[1]
    across = rolling["sideslip"] + rolling["slope"] * a[1] ** 2
    seen = ca.vertcat(speed, -slip * speed)
    fastest = ca.fmax(speed**2, expected[0] ** 2)
    R = ca.diag(ca.vertcat(rolling["speed"], across) * fastest + rolling["floor"])
    e.take(seen - expected, H, R, gate=ca.SX(_GATE), used=rolling["used"])
