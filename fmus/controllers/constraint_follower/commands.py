"""Accelerations asked for, integrated to speed and yaw rate, and the commands made of them, within a car's limits.

The integrals stay within `windup.*` of what is measured: beyond, the car does not follow, and a command that ran on
would have to run all the way back first. The commands are the integrals with the lead added, and move no faster than
`limit.*` allow: where the integral itself takes the whole rate there is none left for the lead.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.constraint_follower.law import Asked
from fmus.controllers.formation import link, realise


class Pair(NamedTuple):
    """Speed [m/s] and yaw rate [rad/s]."""

    speed: ca.SX
    yaw_rate: ca.SX


class Commands(NamedTuple):
    """The integrals one sample later, and the commands with their rates and limits."""

    integrals: Pair
    speed: realise.Realised
    yaw_rate: realise.Realised


def near(p: Signals, u: Signals, integrals: Pair) -> Pair:
    """The integrals, not further than `windup.*` from the measured speed and yaw rate."""
    v, w = u["estimate.velocity.x"], u["estimate.yaw_rate"]
    dv, dw = p["windup.speed"], p["windup.yaw_rate"]
    speed = clip(integrals.speed, ca.fmax(v - dv, 0), ca.fmax(v + dv, 0))
    return Pair(speed, clip(integrals.yaw_rate, w - dw, w + dw))


def command(
    p: Signals, u: Signals, asked: Asked, linked: link.Link, alone: ca.SX, integrals: Pair, last: Pair
) -> Commands:
    """The commands after `last`; with `alone` = 1 nothing is left to follow: hold, then stop, without a lead."""
    followed = _follow(p, u, asked, integrals, last)
    stopped = _stop(p, u, linked, last)
    v, w = (
        realise.Realised(*(ca.if_else(alone, *pair) for pair in zip(stop, follow, strict=True)))
        for stop, follow in zip(stopped, followed[1:], strict=True)
    )
    kept = (ca.if_else(alone, now.value, then) for now, then in zip((v, w), followed.integrals, strict=True))
    return Commands(Pair(*kept), v, w)


def _follow(p: Signals, u: Signals, asked: Asked, integrals: Pair, last: Pair) -> Commands:
    T, measured = p["sample_period"], u["estimate.velocity.x"]
    v = realise.speed_at_rate(p, integrals.speed, asked.acceleration)
    led = v.value + p["lead.speed"] * v.rate
    speed = realise.speed_at_rate(p, last.speed, (clip(led, 0, p["limit.speed"]) - last.speed) / T)
    turn = integrals.yaw_rate + T * asked.yaw_acceleration
    w = realise.yaw_rate(p, integrals.yaw_rate, turn, ca.fmax(v.value, measured))
    led_turn = w.value + p["lead.yaw_rate"] * w.rate
    yaw_rate = realise.yaw_rate(p, last.yaw_rate, led_turn, ca.fmax(speed.value, measured))
    return Commands(Pair(v.value, w.value), _either(speed, v), _either(yaw_rate, w))


def _stop(p: Signals, u: Signals, linked: link.Link, last: Pair) -> tuple[realise.Realised, realise.Realised]:
    """Straight on from the commands as they are, at the last known speed, then to a stop."""
    speed = link.hold_speed(p, linked.state, last.speed, p["realise.speed_time"])
    fastest = ca.fmax(speed.value, u["estimate.velocity.x"])
    return speed, realise.yaw_rate(p, last.yaw_rate, ca.SX(0), fastest)


def _either(command: realise.Realised, integral: realise.Realised) -> realise.Realised:
    """The command, limited where it or its integral is."""
    return command._replace(limited=ca.fmax(command.limited, integral.limited))
