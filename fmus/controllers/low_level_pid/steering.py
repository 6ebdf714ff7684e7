"""Yaw rate loop, Ackermann geometry and steering servos."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.low_level_pid.error_ode import double_pole, triple_pole


@dataclass(frozen=True, slots=True)
class Demand:
    """The demanded steering angle: its rate now [rad/s], its next value [rad], the next yaw integral, limited 0/1."""

    rate: ca.SX
    angle: ca.SX
    integral: ca.SX
    limited: ca.SX


def demand(p: Signals, v: ca.SX, feedforward: ca.SX, error: ca.SX, kept: tuple[ca.SX, ca.SX]) -> Demand:
    """delta = delta_ff + I_zz / (l_F' C_F) (2 lambda e + lambda^2 int e) through a limited first-order filter.

    error [rad/s] of the yaw rate, feedforward [rad], kept: state of the filter [rad] and integral of the error [rad].
    With `yaw.fed_through` delta is the feedforward alone and the integral rests.
    """
    angle, integral = kept
    T = p["sample_period"]
    fade = clip(v / p["yaw.fade_speed"], 0, 1)
    gain = p["design.yaw_inertia"] / ((p["design.l_f"] - p["design.pneumatic_trail"]) * p["design.cornering_front"])
    closed = p["yaw.enabled"] * (1 - p["yaw.fed_through"])
    wanted = closed * fade * gain * double_pole(p["yaw.pole"], error, integral)
    feedback = clip(wanted, -p["yaw.limit"], p["yaw.limit"])
    target = feedforward + feedback
    reached = clip(target, -p["steering.angle_limit"], p["steering.angle_limit"])
    speed = (1 - ca.exp(-T / p["steering.filter_time"])) / T * (reached - angle)
    rate = clip(speed, -p["steering.rate_limit"], p["steering.rate_limit"])
    limited = ca.logic_or(ca.logic_or(feedback != wanted, reached != target), rate != speed)
    frozen = ca.logic_or(ca.logic_or(limited, fade <= 0), p["yaw.fed_through"])
    return Demand(rate, angle + T * rate, integral + ca.if_else(frozen, 0, T * error), limited)


def ackermann(delta: ca.SX, half_track: ca.SX, wheelbase: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Left and right angles (2) of delta at the middle of the axle, and their derivatives by delta (2).

    tan(delta_L,R) = tan(delta) / (1 -+ half_track tan(delta) / wheelbase)
    """
    tangent = ca.tan(delta)
    signs = ca.DM([-1.0, 1.0])
    divisor = 1 + signs * half_track / wheelbase * tangent
    wheels = tangent / divisor
    slope = (1 + tangent**2) / (divisor**2 * (1 + wheels**2))
    return ca.atan(wheels), slope


def servo(
    p: Signals, wanted: tuple[ca.SX, ca.SX], measured: tuple[ca.SX, ca.SX], integral: ca.SX, trail_force: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Torques (2) [N.m], next integrals (2) and saturation 0/1 from the (angle, rate) wanted and measured.

    T = J (3 lambda e' + 3 lambda^2 e + lambda^3 int e) + b delta' + t F_y / 2: damping and aligning moment made up for.
    """
    largest = p["steering.torque_limit"]
    error, rate = wanted[0] - measured[0], wanted[1] - measured[1]
    computed = p["design.steer_inertia"] * triple_pole(p["steering.pole"], rate, error, integral)
    opposing = p["design.steer_damping"] * measured[1] + p["design.pneumatic_trail"] * trail_force / 2
    demanded = p["steering.enabled"] * (computed + opposing)
    torque = clip(demanded, -largest, largest)
    saturated = torque != demanded
    growth = p["sample_period"] * error * (1 - saturated)
    return torque, integral + growth, ca.fmax(saturated[0], saturated[1])


def front_force(p: Signals, v: ca.SX, yaw_rate: ca.SX) -> ca.SX:
    """Lateral force of the front axle [N] in steady cornering: m v omega l_r / (l_f + l_r)."""
    l_f, l_r = p["design.l_f"], p["design.l_r"]
    return p["design.mass"] * v * yaw_rate * l_r / (l_f + l_r)
