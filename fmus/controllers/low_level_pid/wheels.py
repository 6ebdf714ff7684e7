"""What is known of the wheels: how fast they would roll, how much they slip, what the road takes from them.

Everything is seen in the direction in which the car moves, so that braking is negative forwards and backwards.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals
from fmus.cars.wheels import FRONT, WHEELS
from fmus.controllers.low_level_pid.speed import WheelTorques

STATES = Layout(
    turning=1,  # 1 once a wheel has been seen turning; until then their speeds may not be wired
    torque=4,  # what motors and brakes gave together in the sample before
    spin=4,  # in the sample before
    load=4,  # torque with which the road resists
)


@dataclass(frozen=True, slots=True)
class Wheels:
    """`direction` 1 or -1, `turning` 0/1, and per wheel (4): speed over the road [m/s], spin [rad/s], load [N.m]."""

    direction: ca.SX
    turning: ca.SX
    speed: ca.SX
    spin: ca.SX
    load: ca.SX


def observe(p: Signals, u: Signals, x: Parts, started: ca.SX, wanted: WheelTorques) -> Wheels:
    """The wheels now; before the first sample the torques `wanted` of them are taken to be their load.

    The load is that of a disturbance observer: M + M'/L = T - J omega'.
    """
    direction = ca.if_else(u["estimate.velocity.x"] < 0, -1, 1)
    spin = direction * u.vector("wheel_speed", WHEELS)
    turning = ca.fmax(x["turning"], ca.mmax(ca.fabs(spin)) > 0)
    T = p["sample_period"]
    seen = x["torque"] - p["design.wheel_inertia"] / T * (spin - x["spin"])
    load = x["load"] + (1 - ca.exp(-T * p["slip.observer"])) * (seen - x["load"])
    load = ca.if_else(ca.logic_and(started, x["turning"]), load, direction * wanted.wheel_torque - wanted.brake_torque)
    return Wheels(direction, turning, direction * speeds(p, u), spin, load)


def speeds(p: Signals, u: Signals) -> ca.SX:
    """Speeds (4) [m/s] at which the wheels move over the road, each in its own plane."""
    v, r, half_track = u.vector("estimate.velocity", "xy"), u["estimate.yaw_rate"], p["design.track"] / 2
    steer = ca.vertcat(u.vector("steer_angle", FRONT), 0, 0)
    x = ca.vertcat(p["design.l_f"], p["design.l_f"], -p["design.l_r"], -p["design.l_r"])
    y = half_track * ca.DM([1, -1, 1, -1])
    return (v[0] - r * y) * ca.cos(steer) + (v[1] + r * x) * ca.sin(steer)


def kept(wheels: Wheels, torque: ca.SX) -> Parts:
    """Next states after `torque` (4) [N.m] has been given."""
    return {"turning": wheels.turning, "torque": torque, "spin": wheels.spin, "load": wheels.load}
