"""What a wheel may be given: limits of its motor, and of its slip by a first-order error equation.

T = M + J lambda (omega_lim - omega), M the torque with which the road resists, takes a wheel to the speed omega_lim by
e' + lambda e = 0. Braking may not be stronger than the T of the lowest speed allowed, driving than that of the highest.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.low_level_pid.wheels import Wheels

_UNLIMITED = 1e9  # N.m
_FADE = 0.05  # part of the motor's largest speed over which its driving torque fades out


@dataclass(frozen=True, slots=True)
class Given:
    """Motor and brake torques (4 each) [N.m], what was taken from the brakes (4) [N.m], limited 0/1 per wheel (4)."""

    motor: ca.SX
    brake: ca.SX
    released: ca.SX
    limited: ca.SX


def motors(p: Signals, wheels: Wheels, torque: ca.SX) -> ca.SX:
    """The motor torques (4) [N.m] within power and speed of a motor: |T omega| <= P, no driving beyond its speed."""
    spin = ca.fabs(wheels.spin)
    largest = ca.fmin(p["motor.power"] / ca.fmax(spin, 1), _UNLIMITED)
    within = clip(torque, -largest, largest)
    fade = clip((1 - spin / p["motor.speed"]) / _FADE, 0, 1)
    return ca.if_else(torque * wheels.direction * wheels.spin > 0, fade * within, within)


def limits(p: Signals, wheels: Wheels) -> tuple[ca.SX, ca.SX]:
    """Lowest and highest torque (4, 4) [N.m] of motor and brake together, never above and never below zero."""
    front, rear = p["slip.limit_front"], p["slip.limit_rear"]
    allowed = ca.vertcat(front, front, rear, rear) * ca.fmax(ca.fabs(wheels.speed), p["slip.least_speed"])
    ease = p["design.wheel_inertia"] * p["slip.pole"]
    low, high = (
        wheels.load + ease * ((wheels.speed + sign * allowed) / p["design.rolling_radius"] - wheels.spin)
        for sign in (-1, 1)
    )
    on = p["slip.enabled"] * wheels.turning
    return ca.if_else(on, ca.fmin(low, 0), -_UNLIMITED), ca.if_else(on, ca.fmax(high, 0), _UNLIMITED)


def limit(p: Signals, wheels: Wheels, motor: ca.SX, brake: ca.SX) -> Given:
    """Motor and brake torques (4 each) [N.m] within the limits; brakes give way before braking motors do."""
    within = motors(p, wheels, motor)
    low, high = limits(p, wheels)
    net = wheels.direction * within - brake
    over, under = ca.fmax(net - high, 0), ca.fmax(low - net, 0)
    released = ca.fmin(under, brake)
    given = within + wheels.direction * (under - released - over)
    return Given(given, brake - released, released, ca.logic_or(given != motor, released > 0))


def balanced(p: Signals, given: Given, before: ca.SX) -> tuple[Given, ca.SX]:
    """Brakes whose yaw moment by unequal release grows no faster than `slip.yaw_moment_rate`, and the next `before`.

    before  largest difference of release (2) [N.m] between left and right, front and rear, in the sample before
    """
    lever = p["design.track"] / (2 * p["design.rolling_radius"])
    allowed = before + p["sample_period"] * p["slip.yaw_moment_rate"] / lever
    other = ca.vertcat(*(given.released[i] for i in (1, 0, 3, 2)))
    least = other - ca.vertcat(allowed[0], allowed[0], allowed[1], allowed[1])
    full = given.brake + given.released
    released = ca.fmin(ca.fmax(given.released, least), full)
    difference = ca.vertcat(ca.fabs(released[0] - released[1]), ca.fabs(released[2] - released[3]))
    limited = ca.logic_or(given.limited, released > given.released)
    return Given(given.motor, full - released, released, limited), difference
