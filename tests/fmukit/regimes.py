"""For every FMU of the catalogue a short drive that makes it work: parameters, inputs over time, and what shows it.

The inputs belong to a car going round a circle at 25 m/s, in closed form, a little disturbed; what is exact
(counts, time stamps, motors) is not disturbed. An FMU at rest,
with nothing to correct or command, would prove little by repeating itself.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from fmukit.interface import AXES, Interface
from fmus.cars.wheels import FRONT, WHEELS
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD

Values = dict[str, float]

SPEED, RATE, GRAVITY = 25.0, 0.16, 9.81  # m/s, rad/s, m/s2
_FIX_PERIOD, _LATENCY, _ANTENNA = 0.1, 0.05, -0.5  # s, s, m forward of O1
_EXACT = ("gps.fix_count", "gps.time", "gps.valid", *(f"motor_available.{wheel}" for wheel in WHEELS))


@dataclass(frozen=True, slots=True)
class Regime:
    """`duration` [s]; `reached` maps outputs to the magnitude each exceeds at the end of the drive."""

    duration: float
    reached: Mapping[str, float]
    inputs: Callable[[float], Values] = lambda t: {}
    parameters: Mapping[str, float] = field(default_factory=dict)

    def at(self, t: float) -> Values:
        """The inputs at time t [s], each disturbed by about a thousandth."""
        noise = random.Random(round(t * 1e6))
        exact = self.inputs(t)
        disturbed = {n: v + noise.uniform(-1, 1) * (1e-3 * abs(v) + 1e-4) for n, v in exact.items()}
        return disturbed | {name: exact[name] for name in _EXACT if name in exact}

    def script(self, step: float) -> list[Values]:
        """The inputs of every step of `step` [s] of the drive."""
        return [self.at(k * step) for k in range(round(self.duration / step))]


def regime(interface: Interface) -> Regime:
    """The drive of an FMU; every FMU of the catalogue needs one here."""
    if interface.name not in _REGIMES:
        raise LookupError(f"tests/fmukit/regimes.py has no drive for {interface.name}: say what makes it work")
    return _REGIMES[interface.name]


def _group(name: str, members: tuple[str, ...], *values: float) -> Values:
    return {f"{name}.{member}": value for member, value in zip(members, values, strict=True)}


def _place(t: float) -> tuple[float, float, float]:
    """Position of O1 and yaw angle at time t."""
    radius = SPEED / RATE
    return radius * math.sin(RATE * t), radius * (1 - math.cos(RATE * t)), RATE * t


def _plant(t: float) -> Values:
    return {
        **_group("wheel_torque", WHEELS, 100.0, 120.0, 200.0, 220.0),
        **_group("brake_torque", WHEELS, 20.0, 20.0, 10.0, 10.0),
        **_group("steer_torque", FRONT, 20.0, 25.0),
        **_group("suspension_force", WHEELS, 200.0, -200.0, 300.0, -300.0),
        **_group("road_friction", WHEELS, 0.9, 1.0, 0.9, 1.0),
        **_group("body_force", AXES, -100.0, 50.0, 20.0),
    }


def _planar_plant(t: float) -> Values:
    return {
        **_group("wheel_torque", WHEELS, 100.0, 120.0, 200.0, 220.0),
        **_group("brake_torque", WHEELS, 20.0, 20.0, 10.0, 10.0),
        **_group("road_friction", WHEELS, 0.9, 1.0, 0.9, 1.0),
        **_group("body_force", AXES[:2], -100.0, 50.0),
        "body_moment.z": 30.0,
        "command.steer_angle": 0.02,
    }


def _imu(t: float) -> Values:
    return {
        **_group("truth.velocity", AXES, SPEED, 0.1, 0.0),
        **_group("truth.acceleration", AXES, 0.5, SPEED * RATE, 0.0),
        **_group("truth.specific_force", AXES, 0.5, SPEED * RATE, GRAVITY),
        **_group("truth.angular_rate", AXES, 0.02, -0.01, RATE),
        **_group("truth.angular_acceleration", AXES, 0.1, 0.1, 0.3),
    }


def _gps(t: float) -> Values:
    x, y, yaw = _place(t)
    return {
        **_group("truth.position", AXES, x, y, 0.5),
        **_group("truth.velocity", AXES, SPEED, 0.1, 0.0),
        **_group("truth", ("roll", "pitch", "yaw"), 0.02, 0.01, yaw),
        **_group("truth.angular_rate", AXES, 0.02, -0.01, RATE),
    }


def _radio(t: float) -> Values:
    x, y, yaw = _place(t)
    return {
        **_group("message.position", AXES[:2], x, y),
        **_group("message.velocity", AXES[:2], SPEED, 0.1),
        **_group("message", ("yaw", "yaw_rate"), yaw, RATE),
    }


def _unicycle(t: float) -> Values:
    return {**_group("command", ("speed", "yaw_rate"), SPEED, RATE), "body_force.x": 500.0, "body_moment.z": 200.0}


def _filter(t: float) -> Values:
    return {
        **_group("accelerometer", AXES, 0.0, SPEED * RATE, GRAVITY),
        **_group("gyroscope", AXES, 0.0, 0.0, RATE),
        **_group("suspension_travel", WHEELS, -0.01, 0.01, -0.01, 0.01),
        **_fix(t),
    }


def _fix(t: float) -> Values:
    """The newest fix: fix k was taken at (k - 1) fix periods and reported after the latency."""
    count = math.floor((t - _LATENCY) / _FIX_PERIOD + 1e-9) + 1
    taken = max(count - 1, 0) * _FIX_PERIOD
    x, y, yaw = _place(taken)
    c, s = math.cos(yaw), math.sin(yaw)
    across = RATE * _ANTENNA
    return {
        **_group("gps.position", AXES, x + c * _ANTENNA, y + s * _ANTENNA, 1.4),
        **_group("gps.velocity", AXES, SPEED * c - across * s, SPEED * s + across * c, 0.0),
        **_group("gps", ("heading", "fix_count", "time", "valid"), yaw, count, taken, float(count > 0)),
    }


def _reference_at(t: float) -> Values:
    x, y, course = _place(t)
    return {"x": x, "y": y, "course": course, "speed": SPEED, "acceleration": 0.5, "curvature": RATE / SPEED}


def _high_level(t: float) -> Values:
    x, y, yaw = _place(t)
    ahead = {
        f"preview[{k}].{name}": value
        for k in range(1, PREVIEW + 1)
        for name, value in _reference_at(t + k * PREVIEW_PERIOD).items()
    }
    return {
        **{f"reference.{name}": value for name, value in _reference_at(t).items()},
        "reference.yaw_rate": RATE,
        **ahead,
        **_group("estimate.position", ("x", "y"), x - 0.4, y + 0.3),
        "estimate.yaw": yaw + 0.02,
        **_group("estimate.velocity", ("x", "y"), SPEED - 0.5, 0.2),
    }


def _mpc(t: float) -> Values:
    return {
        **_high_level(t),
        "estimate.yaw_rate": RATE + 0.01,
        **_group("wheel_speed", WHEELS, *((SPEED / 0.302,) * 4)),
        **_group("motor_available", WHEELS, *((1.0, 1.0, 1.0, 1.0) if t < 0.3 else (1.0, 0.9, 0.5, 0.0))),
    }


def _low_level(t: float) -> Values:
    return {
        **_group("command", ("acceleration", "speed", "yaw_rate"), 0.5, SPEED + 0.3, RATE + 0.02),
        **_group("command", ("steer_feedforward", "heave", "roll", "pitch"), 0.03, 0.005, 0.01, -0.01),
        **_group("command.wheel_torque", WHEELS, 50.0, 60.0, 70.0, 80.0),
        **_group("command.brake_torque", WHEELS, 10.0, 20.0, 30.0, 40.0),
        "command.steer_angle": 0.02,
        **_group("estimate", ("velocity.x", "velocity.y", "yaw_rate"), SPEED, 0.1, RATE),
        **_group("estimate", ("roll", "pitch", "roll_rate", "pitch_rate"), 0.02, 0.01, 0.05, -0.05),
        **_group("wheel_speed", WHEELS, 80.0, 80.5, 80.0, 76.0),
        **_group("steer_angle", FRONT, 0.029, 0.028),
        **_group("steer_rate", FRONT, 0.01, 0.01),
        **_group("suspension_travel", WHEELS, -0.01, 0.01, -0.01, 0.01),
        **_group("suspension_rate", WHEELS, -0.05, 0.05, -0.05, 0.05),
    }


def _follower(t: float) -> Values:
    """Some 12 m behind and 2 m to the right of a leader that goes round the circle."""
    taken = max(t - 0.03, 0.0)
    (x, y, yaw), (own_x, own_y, own_yaw) = _place(taken), _place(t - 0.5)
    return {
        **_group("leader.position", ("x", "y"), x, y),
        "leader.yaw": yaw,
        "leader.age": t - taken + 0.001,
        **_group("estimate.position", ("x", "y"), own_x, own_y),
        "estimate.yaw": own_yaw,
        **_group("estimate.velocity", ("x", "y"), SPEED - 0.5, 0.2),
        "estimate.yaw_rate": RATE + 0.01,
        **_group("formation", ("x", "y"), -12.0, 0.5),
        "feedforward.speed": SPEED,
    }


def _messaged_follower(t: float) -> Values:
    """The same follower, told of its leader's motion too, and of a trajectory."""
    return {
        **_follower(t),
        **_group("leader.velocity", ("x", "y"), SPEED, -0.1),
        "leader.yaw_rate": RATE,
        **{f"reference.{name}": value for name, value in _reference_at(t).items()},
    }


_AT_ONCE = {"acceleration.start": 0.0, "acceleration.rise": 0.2, "weave.start": 0.0, "weave.rise": 0.3}
_REGIMES = {
    "Vehicle16Dof": Regime(
        0.1,
        {"velocity.x": 20.0, "tyre_force_y.fl": 100.0, "slip_angle.fr": 1e-3, "steer_angle.fl": 1e-3},
        _plant,
        {"initial.speed": SPEED},
    ),
    "DoubleTrack": Regime(
        0.1,
        {"velocity.x": 20.0, "tyre_force_y.fl": 100.0, "slip_angle.fr": 1e-3, "steer_angle.fl": 1e-2},
        _planar_plant,
        {"initial.speed": SPEED},
    ),
    "Imu": Regime(0.2, {"accelerometer.y": 2.0, "gyroscope.z": 0.1}, _imu),
    "GpsReceiver": Regime(0.5, {"gps.fix_count": 3.0, "gps.valid": 0.5, "gps.time": 0.2, "gps.heading": 0.01}, _gps),
    "Radio": Regime(
        0.5, {"leader.count": 3.0, "leader.valid": 0.5, "leader.position.x": 5.0, "leader.yaw_rate": 0.1}, _radio
    ),
    "Unicycle": Regime(
        0.1,
        {"velocity.x": 20.0, "angular_rate.z": 0.03, "acceleration.y": 0.5, "position.x": 1.0},
        _unicycle,
        {"initial.speed": SPEED},
    ),
    "NavigationFilter": Regime(
        0.4,
        {"fix.used_count": 2.0, "nis.position": 1e-6, "nis.velocity": 1e-6, "nis.heading": 1e-6},
        _filter,
        {"initial.speed": SPEED},
    ),
    "ReferenceTrajectory": Regime(
        0.8, {"reference.curvature": 1e-3, "reference.acceleration": 1.0, "reference.x": 10.0}, parameters=_AT_ONCE
    ),
    "HighLevelLqr": Regime(
        0.6,
        {
            "feedback.acceleration": 0.01,
            "feedback.yaw_rate": 1e-3,
            "command.steer_feedforward": 0.01,
            "command.speed": 20,
        },
        _high_level,
    ),
    "MpcAllocator": Regime(
        0.6,
        {
            "wheel_torque.fl": 20.0,
            "command.steer_angle": 1e-3,
            "solver.iterations": 5.0,
            "disturbance.yaw_rate": 1e-2,
            "residual.moment_z": 0.01,
        },
        _mpc,
    ),
    "RecedingHorizonPlanner": Regime(
        1.6,
        {"reference.x": 25.0, "reference.speed": 18.0, "reference.acceleration": 1.0, "problem.count": 2.0},
        parameters={"initial.lateral": 1.0, "initial.heading": 0.05},
    ),
    "AdaptiveFollower": Regime(
        0.6,
        {
            "command.speed": 20.0,
            "command.yaw_rate": 0.05,
            "command.steer_feedforward": 5e-3,
            "error.y": 0.1,
            "velocity.y": 0.01,
        },
        _follower,
    ),
    "ConstraintFollower": Regime(
        0.6,
        {
            "command.speed": 20.0,
            "command.acceleration": 0.01,
            "command.yaw_rate": 0.05,
            "command.steer_feedforward": 5e-3,
            "error.y": 0.1,
            "multiplier.offset.x": 1e-3,
            "multiplier.heading": 1e-3,
            "leader.yaw_acceleration": 1e-6,
            "constraint.residual": 1e-6,
        },
        _messaged_follower,
        {"constraint.heading": True, "constraint.distance": True, "headway": 0.1},
    ),
    "LowLevelPid": Regime(
        0.06,
        {"wheel_torque.fl": 20.0, "steer_torque.fl": 1.0, "suspension_force.rl": 20.0, "steer_demand": 0.01},
        _low_level,
    ),
}
