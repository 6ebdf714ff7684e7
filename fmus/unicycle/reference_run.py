"""Unicycle: away from rest, a figure of eight begun, a push from behind, and to rest."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun, rise

_SPEED, _YAW_RATE, _PUSH = 15.0, 0.3, 3000.0


def _inputs(t: float) -> dict[str, float]:
    """Commands and push at time t [s]."""
    return {
        "command.speed": _SPEED * (rise(t, 0.5, 3.0) - rise(t, 16.0, 3.0)),
        "command.yaw_rate": _YAW_RATE * (rise(t, 4.0, 0.5) - 2 * rise(t, 9.0, 1.0) + rise(t, 15.0, 0.5)),
        "body_force.x": _PUSH if 7.0 <= t < 7.5 else 0.0,
    }


RUN = ReferenceRun(
    "The vehicle drives off, turns left, is pushed from behind for half a second, turns right and stops.",
    stop=20.0,
    step=0.01,
    inputs=_inputs,
    plots={
        "Position": ("position.x", "position.y"),
        "Velocity": ("velocity.x",),
        "Yaw rate": ("angular_rate.z",),
        "Acceleration": ("acceleration.x", "acceleration.y"),
    },
)
