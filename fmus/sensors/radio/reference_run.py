"""Radio: the sender drives a circle."""

from __future__ import annotations

from math import cos, sin

from fmukit.reference_run import ReferenceRun

_SPEED, _RADIUS = 20.0, 50.0


def _inputs(t: float) -> dict[str, float]:
    """What the sender knows of itself at time t [s]: yaw rate speed/radius, no sideslip."""
    yaw = _SPEED * t / _RADIUS
    return {
        "message.position.x": _RADIUS * sin(yaw),
        "message.position.y": _RADIUS * (1.0 - cos(yaw)),
        "message.yaw": yaw,
        "message.velocity.x": _SPEED,
        "message.yaw_rate": _SPEED / _RADIUS,
    }


RUN = ReferenceRun(
    "The sender drives a circle of 50 m radius at 20 m/s; messages arrive late and are held, one in 100 is lost.",
    stop=8.0,
    step=0.01,
    inputs=_inputs,
    plots={
        "Position received": ("leader.position.x", "leader.position.y"),
        "Velocity received": ("leader.velocity.x", "leader.velocity.y"),
        "Yaw received": ("leader.yaw",),
        "Age of the message": ("leader.age",),
    },
)
