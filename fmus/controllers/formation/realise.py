"""Wanted speed and yaw rate as commands a car can follow: limits, rates, and the steering of a steady turn.

Every function tells how much of what was wanted is not realised; a law must not learn or integrate while it is.
"""

from __future__ import annotations

from typing import NamedTuple

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip

_SLOWEST = 3.0  # m/s; slower cars steer as at this speed
_SHORTEST = 1e-6  # s; a time constant of zero
_NOTHING = 1e-9  # what rounding may leave unrealised


class Realised(NamedTuple):
    """A command, its rate over the sample, and 1 where it is not what was wanted, else 0."""

    value: ca.SX
    rate: ca.SX
    limited: ca.SX


def speed_towards(p: Signals, last: ca.SX, wanted: ca.SX, time: ca.SX) -> Realised:
    """Command.speed [m/s] after `last`: v' = (wanted - v)/time, exactly over a sample, within the limits."""
    T = p["sample_period"]
    within = clip(wanted, 0, p["limit.speed"])
    share = 1 - ca.exp(-T / ca.fmax(time, _SHORTEST))
    realised = speed_at_rate(p, last, share * (within - last) / T)
    return realised._replace(limited=ca.fmax(realised.limited, _differs(wanted, within)))


def speed_at_rate(p: Signals, last: ca.SX, wanted: ca.SX) -> Realised:
    """Command.speed [m/s] after `last` with the acceleration `wanted` [m/s2], within the limits."""
    T = p["sample_period"]
    braking, driving = p["limit.deceleration"], p["limit.acceleration"]
    rate = clip(wanted, ca.fmax(-braking, -last / T), driving)
    rate = clip(rate, -braking, ca.fmax((p["limit.speed"] - last) / T, -braking))
    return Realised(ca.fmax(last + T * rate, 0), rate, _differs(wanted, rate))


def yaw_rate(p: Signals, last: ca.SX, wanted: ca.SX, v: ca.SX) -> Realised:
    """Command.yaw_rate [rad/s] after `last`, at the car's own speed v [m/s]: grip, smallest circle, rate of change.

    |w| <= min(mu g/v, kappa_max v): a car at rest does not turn.
    """
    T, most = p["sample_period"], yaw_rate_limit(p, v)
    within = clip(wanted, -most, most)
    step = T * p["limit.yaw_acceleration"]
    value = clip(within, last - step, last + step)
    return Realised(value, (value - last) / T, _differs(wanted, value))


def yaw_rate_limit(p: Signals, v: ca.SX) -> ca.SX:
    """Largest |yaw rate| [rad/s] at speed v [m/s]."""
    forward = ca.fmax(v, 0)
    grip = p["limit.friction"] * p["design.gravity"] / ca.fmax(forward, _SHORTEST)
    return ca.fmin(grip, p["limit.curvature"] * forward)


def steering(p: Signals, v: ca.SX, w: ca.SX) -> ca.SX:
    """Steering angle [rad] of the steady turn with yaw rate w [rad/s] at speed v [m/s], linear single-track vehicle.

    delta = L w/v + (m v w/L)(l_R'/C_F - l_F'/C_R): F_F = m v w l_R'/L, F_R = m v w l_F'/L, with the arms
    l_F' = l_F - t, l_R' = l_R + t of the axle forces.
    """
    t, speed = p["design.pneumatic_trail"], ca.fmax(v, _SLOWEST)
    l_F, l_R = p["design.l_f"] - t, p["design.l_r"] + t
    L = l_F + l_R
    understeer = l_R / p["design.cornering_front"] - l_F / p["design.cornering_rear"]
    return L * w / speed + p["design.mass"] * speed * w / L * understeer


def _differs(wanted: ca.SX, given: ca.SX) -> ca.SX:
    return ca.fabs(wanted - given) > _NOTHING
