"""AdaptiveFollower: its wanted place begins to run ahead of it, without a car to answer."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun

_SPEED, _FASTER, _BEHIND, _LEFT = 20.0, 0.4, -12.0, 4.0
_PERIOD = 0.1


def _inputs(t: float) -> dict[str, float]:
    """A leader at 20.4 m/s that sends its pose every 0.1 s, and an own car at 20 m/s that was in its place."""
    age = t % _PERIOD
    return {
        "leader.position.x": (_SPEED + _FASTER) * (t - age),
        "leader.age": age,
        "formation.x": _BEHIND,
        "formation.y": _LEFT if t < 1.0 else _LEFT - 1.0,
        "estimate.position.x": _BEHIND + _SPEED * t,
        "estimate.position.y": _LEFT,
        "estimate.velocity.x": _SPEED,
    }


RUN = ReferenceRun(
    "The leader drives 0.4 m/s faster than the follower, which is told to keep 12 m behind and 4 m to its left, from"
    " 1 s on 3 m. The own car does not answer: the learnt speed of the leader grows until the command is limited.",
    stop=5.0,
    step=0.02,
    inputs=_inputs,
    plots={
        "Error of the hand point": ("error.x", "error.y"),
        "Speed": ("command.speed", "velocity.x"),
        "Yaw rate": ("command.yaw_rate",),
        "Wanted place": ("offset.x", "offset.y"),
    },
)
