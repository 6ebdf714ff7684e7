"""Imu: at rest, then a yaw oscillation under braking."""

from __future__ import annotations

from math import cos, pi, sin

from fmukit.reference_run import ReferenceRun, rise

_GRAVITY, _BRAKING, _YAW_RATE, _PULSATION = 9.81, -3.0, 0.3, 2.0 * pi * 0.5


def _inputs(t: float) -> dict[str, float]:
    """Level motion: specific force [m/s2], yaw rate [rad/s] and yaw acceleration [rad/s2] at time t [s]."""
    since = max(t - 1.0, 0.0)
    return {
        "truth.specific_force.x": _BRAKING * rise(t, 1.0, 0.5),
        "truth.specific_force.z": _GRAVITY,
        "truth.angular_rate.z": 0.5 * _YAW_RATE * (1.0 - cos(_PULSATION * since)),
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
