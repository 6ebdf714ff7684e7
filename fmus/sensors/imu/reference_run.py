"""Imu: at rest, then a yaw oscillation under braking."""

from __future__ import annotations

from math import cos, pi, sin

from fmukit.reference_run import ReferenceRun, rise

_GRAVITY, _BRAKING, _SPEED, _YAW_RATE, _PULSATION = 9.81, 3.0, 25.0, 0.3, 2.0 * pi * 0.5
_BEGIN, _RISE = 1.0, 0.5


def _speed(t: float) -> float:
    """Speed [m/s] at time t [s]: the integral of -_BRAKING rise(t, _BEGIN, _RISE)."""
    xi = min(max((t - _BEGIN) / _RISE, 0.0), 1.0)
    return _SPEED - _BRAKING * (_RISE * xi**4 * (2.5 + xi * (xi - 3.0)) + max(t - _BEGIN - _RISE, 0.0))


def _inputs(t: float) -> dict[str, float]:
    """Level motion without sideslip at time t [s]."""
    since, speed, braking = max(t - _BEGIN, 0.0), _speed(t), -_BRAKING * rise(t, _BEGIN, _RISE)
    rate = 0.5 * _YAW_RATE * (1.0 - cos(_PULSATION * since))
    force = {"x": braking, "y": speed * rate}
    return {
        **{f"truth.acceleration.{axis}": value for axis, value in force.items()},
        **{f"truth.specific_force.{axis}": value for axis, value in (force | {"z": _GRAVITY}).items()},
        "truth.velocity.x": speed,
        "truth.angular_rate.z": rate,
        "truth.angular_acceleration.z": 0.5 * _YAW_RATE * _PULSATION * sin(_PULSATION * since),
    }


RUN = ReferenceRun(
    "The unit rests for a second, then the car brakes and its yaw rate goes up and down twice.",
    stop=5.0,
    step=0.005,
    inputs=_inputs,
    plots={
        "Accelerometer, horizontal": ("accelerometer.x", "accelerometer.y"),
        "Accelerometer, vertical": ("accelerometer.z",),
        "Gyroscope": ("gyroscope.x", "gyroscope.y", "gyroscope.z"),
    },
)
