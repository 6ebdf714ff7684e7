"""GpsReceiver: a level circle at constant speed."""

from __future__ import annotations

from math import cos, sin

from fmukit.reference_run import ReferenceRun

_SPEED, _RADIUS = 20.0, 50.0


def _inputs(t: float) -> dict[str, float]:
    """The true motion at time t [s]: yaw rate speed/radius, no sideslip."""
    yaw = _SPEED * t / _RADIUS
    return {
        "truth.position.x": _RADIUS * sin(yaw),
        "truth.position.y": _RADIUS * (1.0 - cos(yaw)),
        "truth.velocity.x": _SPEED,
        "truth.yaw": yaw,
        "truth.angular_rate.z": _SPEED / _RADIUS,
    }


RUN = ReferenceRun(
    "The car drives a circle of 50 m radius at 20 m/s; the receiver reports each fix late and holds it.",
    stop=8.0,
    step=0.01,
    inputs=_inputs,
    plots={
        "Position reported": ("gps.position.x", "gps.position.y"),
        "Velocity reported": ("gps.velocity.x", "gps.velocity.y"),
        "Heading reported": ("gps.heading",),
        "Age of the fix": ("gps.age",),
    },
)
