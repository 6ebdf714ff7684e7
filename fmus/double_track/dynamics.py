"""The planner's double-track car down to rest: states in body components, torques for forces, a steering actuator.

At speed the forces are those of `model.motion`; README.md says what changes towards rest.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals
from fmus.cars.double_track import DoubleTrackCar, double_track_car
from fmus.cars.wheels import WHEELS
from fmus.clip import clip
from fmus.double_track.model import wheel_loads
from fmus.single_track.forces import air_drag, ellipse, lateral, rolling_coefficient
from fmus.vehicle16dof.friction import dry

STATES = Layout(
    position=2,  # of O1 in the world
    yaw=1,
    velocity=2,  # of O1 in the body frame
    yaw_rate=1,
    steer=1,
    transfer=2,  # accelerations a_x, a_y behind the wheel loads
    slip=4,  # of the wheels, which only their speeds show
)

_LEAST_TORQUE = 1e-9


@dataclass(frozen=True, slots=True)
class PlanarInstant:
    """The car evaluated: body accelerations [m/s2], yaw acceleration, steering rate, and per wheel (4 each)
    longitudinal, lateral and normal force [N], slip angle and rolling velocity V_x [m/s].
    """

    acceleration: ca.SX
    yaw_acceleration: ca.SX
    steer_rate: ca.SX
    F_x: ca.SX
    F_y: ca.SX
    F_z: ca.SX
    alpha: ca.SX
    V_x: ca.SX


def evaluate(p: Signals, u: Signals, x: Parts) -> PlanarInstant:
    """Everything instantaneous about the car in state x under the inputs u."""
    c = double_track_car(p)
    F_z = ca.fmax(wheel_loads(c, x["transfer"][0], x["transfer"][1]), c.least_load)
    steer = ca.vertcat(x["steer"], x["steer"], 0, 0)
    cos, sin = ca.cos(steer), ca.sin(steer)
    X, Y = (ca.vertcat(*column) for column in zip(*c.wheel_positions, strict=True))
    v_x, v_y = x["velocity"][0] - x["yaw_rate"] * Y, x["velocity"][1] + x["yaw_rate"] * X
    V_x, V_y = v_x * cos + v_y * sin, v_y * cos - v_x * sin
    speed: Any = ca.sqrt(ca.sumsqr(x["velocity"]))
    alpha = ca.atan2(V_y, ca.fmax(ca.fabs(V_x), p["low_speed.speed"]))
    U, rolling = _longitudinal(p, u, c, V_x, rolling_coefficient(c.planar, speed) * F_z)
    road = u.vector("road_friction", WHEELS)
    U, grip = _combined(p, U, F_z * road)
    F_x, F_y = U - rolling, _lateral(c, alpha, F_z, road) * grip
    f_x, f_y = F_x * cos - F_y * sin, F_x * sin + F_y * cos
    air = air_drag(c.planar, speed) * clip(x["velocity"][0] / p["low_speed.speed"], -1, 1)
    force = ca.vertcat(_sum(f_x) - air, _sum(f_y)) + u.vector("body_force", "xy")
    moment = _sum(X * f_y - Y * f_x) + u["body_moment.z"]
    return PlanarInstant(
        force / c.planar.m, moment / c.planar.I_zz, steering_rate(p, u, x["steer"]), F_x, F_y, F_z, alpha, V_x
    )


def derivative(p: Signals, u: Signals, x: Parts) -> Parts:
    """x' by name."""
    now = evaluate(p, u, x)
    v_x, v_y, r, a = x["velocity"][0], x["velocity"][1], x["yaw_rate"], now.acceleration
    c, s = ca.cos(x["yaw"]), ca.sin(x["yaw"])
    return {
        "position": ca.vertcat(v_x * c - v_y * s, v_x * s + v_y * c),
        "yaw": r,
        "velocity": a + r * ca.vertcat(v_y, -v_x),
        "yaw_rate": now.yaw_acceleration,
        "steer": now.steer_rate,
        "transfer": (a - x["transfer"]) / p["load.lag"],
        "slip": (clip(now.F_x / (p["tyre.slip_stiffness"] * now.F_z), -1, 1) - x["slip"]) / p["tyre.slip_lag"],
    }


def steering_rate(p: Signals, u: Signals, delta: ca.SX) -> ca.SX:
    """delta' [rad/s]: a lag towards the commanded angle, which is limited, with limited rate."""
    asked = clip(u["command.steer_angle"], -p["steering.limit"], p["steering.limit"])
    return clip((asked - delta) / p["steering.lag"], -p["steering.rate_limit"], p["steering.rate_limit"])


def _longitudinal(p: Signals, u: Signals, c: DoubleTrackCar, V_x: ca.SX, rolling: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Force of motor and brake, and rolling resistance (4 each) [N].

    Brake and rolling resistance are one dry friction, shared in proportion to their capacities.
    """
    motor = u.vector("motor_available", WHEELS) * u.vector("wheel_torque", WHEELS)
    drive, brake = motor / c.planar.R, u.vector("brake_torque", WHEELS) / c.planar.R
    front, rear = c.planar.static_loads
    mass = ca.vertcat(front, front, rear, rear) / (2 * c.planar.g)
    capacity = brake + rolling
    friction = dry(capacity, drive, mass * V_x, p["low_speed.stick_time"])
    part = brake / (capacity + _LEAST_TORQUE)
    return drive - part * friction, (1 - part) * friction


def _combined(p: Signals, U: ca.SX, load: ca.SX) -> tuple[ca.SX, ca.SX]:
    """U within the grip of `load` [N], and what is left of the lateral force; both untouched without combined slip."""
    mu: Any = p["tyre.friction"]
    on = p["tyre.combined_slip"]
    return ca.if_else(on, clip(U, -mu * load, mu * load), U), ca.if_else(on, ellipse(U, load, mu), 1)


def _lateral(c: DoubleTrackCar, alpha: ca.SX, F_z: ca.SX, road: ca.SX) -> ca.SX:
    """F_y (4) [N]: the axle's formula with its peak in proportion to load and road; the slip stiffness keeps."""
    mu: Any = road
    front, rear = c.planar.static_loads
    axles = ((c.planar.front, front),) * 2 + ((c.planar.rear, rear),) * 2
    forces = [
        lateral(replace(tyre, B=tyre.B / mu[i]), -alpha[i], mu[i] * tyre.D * F_z[i] / static)
        for i, (tyre, static) in enumerate(axles)
    ]
    return ca.vertcat(*forces)


def _sum(wheels: ca.SX) -> ca.SX:
    """Left and right paired first, so that a mirrored car rounds alike."""
    return (wheels[0] + wheels[1]) + (wheels[2] + wheels[3])
