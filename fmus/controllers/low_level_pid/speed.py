"""Speed loop: the longitudinal force of a double pole error equation, shared between motors and brakes."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca

from fmukit.kernel import Signals
from fmus.clip import clip
from fmus.controllers.low_level_pid.error_ode import double_pole


@dataclass(frozen=True, slots=True)
class WheelTorques:
    """Result of the speed loop: torques of the four wheels [N.m], saturation 0/1, standing 0/1.

    `growth` [m] is by how much the integral grows unless something further limits the torques.
    """

    wheel_torque: ca.SX
    brake_torque: ca.SX
    saturated: ca.SX
    growth: ca.SX
    standing: ca.SX


def drive(p: Signals, v: ca.SX, v_d: ca.SX, a_d: ca.SX, integral: ca.SX) -> WheelTorques:
    """F = (m + 4 J_w / r^2) (a_d + 2 lambda e + lambda^2 int e) + drag + rolling resistance, e = v_d - v.

    v, v_d [m/s] measured and filtered commanded speed, a_d [m/s2] filtered commanded acceleration.
    """
    m, g, T = p["design.mass"], p["design.gravity"], p["sample_period"]
    r = p["design.rolling_radius"]
    error = v_d - v
    feedback = p["speed.enabled"] * double_pole(p["speed.pole"], error, integral)
    rotating = 4 * p["design.wheel_inertia"] / r**2
    demand = (m + rotating) * (a_d + feedback) + resistance(p, v)
    F = clip(demand, -p["speed.brake_limit"] * m * g, p["speed.drive_limit"] * m * g)
    saturated = demand != F
    standing = _standing(p, v, v_d)
    hold = p["speed.hold_force"] * m * g
    driving = (1 - standing) * ca.fmax(F, 0)
    braking = ca.if_else(standing, hold, ca.fmax(-F, 0))
    return WheelTorques(
        wheel_torque=r * driving * _shares(p["speed.drive_front"]),
        brake_torque=r * braking * _shares(p["speed.brake_front"]),
        saturated=saturated,
        growth=ca.if_else(saturated, 0, T * error),
        standing=standing,
    )


def or_fed_through(p: Signals, closed: WheelTorques, wheel_torque: ca.SX, brake_torque: ca.SX) -> WheelTorques:
    """The result of the closed loop, or with `speed.fed_through` the commanded torques (4 each) [N.m] as they are."""
    fed = p["speed.fed_through"]
    loop = 1 - fed
    return replace(
        closed,
        wheel_torque=ca.if_else(fed, wheel_torque, closed.wheel_torque),
        brake_torque=ca.if_else(fed, brake_torque, closed.brake_torque),
        saturated=loop * closed.saturated,
        growth=loop * closed.growth,
        standing=loop * closed.standing,
    )


def resistance(p: Signals, v: ca.SX) -> ca.SX:
    """Drag and rolling resistance [N] at speed v; smooth through zero."""
    drag = 0.5 * p["design.air_density"] * p["design.drag_area"] * v * ca.fabs(v)
    speed = ca.fabs(v)
    names = ("constant", "linear", "quartic")
    constant, linear, quartic = (p[f"design.rolling.{name}"] for name in names)
    rolling = constant + linear * speed + quartic * speed**4
    return drag + p["design.mass"] * p["design.gravity"] * rolling * ca.tanh(v / 0.2)


def _standing(p: Signals, v: ca.SX, v_d: ca.SX) -> ca.SX:
    """1 when the command is to stand and the car nearly does."""
    return ca.logic_and(v_d < 0.1 * p["speed.hold_below"], ca.fabs(v) < p["speed.hold_below"])


def _shares(front: ca.SX) -> ca.SX:
    return ca.vertcat(front, front, 1 - front, 1 - front) / 2
