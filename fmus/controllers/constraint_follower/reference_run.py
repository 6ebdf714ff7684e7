"""ConstraintFollower: beside a leader in a bend, told to move behind it, without a car to answer."""

from __future__ import annotations

from math import cos, floor, sin

from fmukit.reference_run import ReferenceRun

_SPEED, _RATE = 20.0, 0.12  # m/s, rad/s
_BESIDE, _BEHIND, _CHANGE = (-8.0, 4.0), (-12.0, 0.0), 0.5  # m, m, s
_PERIOD, _LATENCY = 0.1, 0.02  # of the messages [s]


def leader(t: float) -> tuple[float, float, float]:
    """(x, y, yaw) of a leader on a circle at time t [s]."""
    radius = _SPEED / _RATE
    return radius * sin(_RATE * t), radius * (1.0 - cos(_RATE * t)), _RATE * t


def message(t: float) -> dict[str, float]:
    """The newest message at time t [s]: sent every 0.1 s, received 0.02 s later."""
    sent = max(floor((t - _LATENCY) / _PERIOD + 1e-9), 0) * _PERIOD
    x, y, yaw = leader(sent)
    return {
        "leader.position.x": x,
        "leader.position.y": y,
        "leader.yaw": yaw,
        "leader.velocity.x": _SPEED,
        "leader.yaw_rate": _RATE,
        "leader.age": t - sent,
    }


def _inputs(t: float) -> dict[str, float]:
    """Messages, a follower that keeps its old place, and the change of the formation, at time t [s]."""
    x, y, yaw = leader(t)
    c, s = cos(yaw), sin(yaw)
    return message(t) | {
        "estimate.position.x": x + c * _BESIDE[0] - s * _BESIDE[1],
        "estimate.position.y": y + s * _BESIDE[0] + c * _BESIDE[1],
        "estimate.yaw": yaw,
        "estimate.velocity.x": _SPEED - _RATE * _BESIDE[1],
        "estimate.velocity.y": _RATE * _BESIDE[0],
        "estimate.yaw_rate": _RATE,
        "formation.x": (_BESIDE if t < _CHANGE else _BEHIND)[0],
        "formation.y": (_BESIDE if t < _CHANGE else _BEHIND)[1],
    }


RUN = ReferenceRun(
    "The leader turns at 20 m/s. The follower, 8 m behind and 4 m to its left, is told after 0.5 s to move behind it,"
    " and does not answer: the wanted place moves away from it along a quintic, and the multipliers with it.",
    stop=3.0,
    step=0.02,
    inputs=_inputs,
    plots={
        "Place wanted": ("offset.x", "offset.y"),
        "Multipliers": ("multiplier.offset.x", "multiplier.offset.y"),
        "Error of the hand": ("error.x", "error.y"),
        "Yaw rate": ("command.yaw_rate",),
    },
)
