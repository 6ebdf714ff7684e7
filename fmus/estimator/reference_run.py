"""NavigationFilter: from rest along a circle, with a gyroscope and an accelerometer that have a bias."""

from __future__ import annotations

from math import cos, floor, sin

from fmukit.reference_run import ReferenceRun
from fmus.estimator.interface import INTERFACE

_GRAVITY, _ACCELERATION, _RADIUS, _REST = 9.81, 2.5, 200.0, 1.0
_GYROSCOPE_BIAS, _ACCELEROMETER_BIAS = 0.005, 0.05
_FIX_PERIOD, _LATENCY = 0.1, 0.05
_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
_IMU_X, _IMU_Y = _START["imu.position.x"], _START["imu.position.y"]
_ANTENNA_X, _ANTENNA_Y = _START["antenna.position.x"], _START["antenna.position.y"]


def _motion(t: float) -> tuple[float, float, float]:
    """Distance [m], speed [m/s] and acceleration [m/s2] along the circle at time t [s]."""
    since = max(t - _REST, 0.0)
    return 0.5 * _ACCELERATION * since**2, _ACCELERATION * since, _ACCELERATION if since else 0.0


def _unit(t: float) -> dict[str, float]:
    """Readings at the unit's own place: centripetal and Euler acceleration of its lever arm, and the biases."""
    _, speed, acceleration = _motion(t)
    rate, change = speed / _RADIUS, acceleration / _RADIUS
    return {
        "accelerometer.x": acceleration - rate**2 * _IMU_X - change * _IMU_Y + _ACCELEROMETER_BIAS,
        "accelerometer.y": speed * rate - rate**2 * _IMU_Y + change * _IMU_X,
        "accelerometer.z": _GRAVITY,
        "gyroscope.z": rate + _GYROSCOPE_BIAS,
    }


def _fix(t: float) -> dict[str, float]:
    """The newest fix reported at time t: that of the antenna at least one latency ago."""
    count = floor((t - _LATENCY) / _FIX_PERIOD + 1e-6) + 1
    if count < 1:
        return {}
    taken = (count - 1) * _FIX_PERIOD
    distance, speed, _ = _motion(taken)
    yaw, rate = distance / _RADIUS, speed / _RADIUS
    c, s, forward, left = cos(yaw), sin(yaw), speed - rate * _ANTENNA_Y, rate * _ANTENNA_X
    return {
        "gps.position.x": _RADIUS * s + c * _ANTENNA_X - s * _ANTENNA_Y,
        "gps.position.y": _RADIUS * (1.0 - c) + s * _ANTENNA_X + c * _ANTENNA_Y,
        "gps.velocity.x": c * forward - s * left,
        "gps.velocity.y": s * forward + c * left,
        "gps.heading": yaw,
        "gps.fix_count": count,
        "gps.time": taken,
        "gps.valid": 1.0,
    }


def _inputs(t: float) -> dict[str, float]:
    """Readings without noise at time t [s]."""
    return _unit(t) | _fix(t)


RUN = ReferenceRun(
    "The car stands for a second, then speeds up along a circle of 200 m radius. Readings have no noise, but the yaw"
    " gyroscope is off by 0.005 rad/s, which the filter finds, and the forward accelerometer by 0.05 m/s², which it"
    " shares between bias and pitch.",
    stop=10.0,
    step=0.01,
    inputs=_inputs,
    plots={
        "Velocity": ("estimate.velocity.x", "estimate.velocity.y"),
        "Yaw": ("estimate.yaw",),
        "Bias of the gyroscope": ("estimate.bias.gyroscope.z",),
        "Bias of the accelerometer": ("estimate.bias.accelerometer.x", "estimate.bias.accelerometer.y"),
        "Standard deviation of the position": ("std.position.x", "std.position.y"),
    },
)
