"""Accelerations asked for, integrated to commands of speed and yaw rate within the limits of a car.

The integrals stay within `windup.*` of what is measured: beyond, the car does not follow, and a command that ran on
would have to run all the way back first.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.constraint_follower.law import Asked
from fmus.controllers.formation import link, realise


class Commands(NamedTuple):
    """The integrated speed and yaw rate with their rates and limits, and both commands with the lead added."""

    speed: realise.Realised
    yaw_rate: realise.Realised
    led_speed: ca.SX
    led_yaw_rate: ca.SX


def near(p: Signals, u: Signals, speed: ca.SX, yaw_rate: ca.SX) -> tuple[ca.SX, ca.SX]:
    """The integrated speed [m/s] and yaw rate [rad/s], not further than `windup.*` from the measured ones."""
    v, w = u["estimate.velocity.x"], u["estimate.yaw_rate"]
    dv, dw = p["windup.speed"], p["windup.yaw_rate"]
    return clip(speed, ca.fmax(v - dv, 0), ca.fmax(v + dv, 0)), clip(yaw_rate, w - dw, w + dw)


def command(p: Signals, asked: Asked, linked: link.Link, alone: ca.SX, speed: ca.SX, yaw_rate: ca.SX) -> Commands:
    """The commands after `speed` and `yaw_rate`; with `alone` = 1 nothing is left to follow: hold, then stop."""
    T = p["sample_period"]
    following = realise.speed_at_rate(p, speed, asked.acceleration)
    holding = link.hold_speed(p, linked.state, speed, p["realise.speed_time"])
    v = realise.Realised(*(ca.if_else(alone, h, f) for h, f in zip(holding, following, strict=True)))
    w = realise.yaw_rate(p, yaw_rate, ca.if_else(alone, 0, yaw_rate + T * asked.yaw_acceleration), v.value)
    most = realise.yaw_rate_limit(p, v.value)
    led_speed = clip(v.value + p["lead.speed"] * v.rate, 0, p["limit.speed"])
    return Commands(v, w, led_speed, clip(w.value + p["lead.yaw_rate"] * w.rate, -most, most))
