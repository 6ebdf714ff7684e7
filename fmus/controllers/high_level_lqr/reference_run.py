"""HighLevelLqr: a lane change driven beside the reference, without a car to answer."""

from __future__ import annotations

from math import atan2, cos, hypot, sin

from fmukit.reference_run import ReferenceRun
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD

_SPEED, _START, _PULSATION, _AMPLITUDE, _OFFSET = 25.0, 0.5, 2.2, 0.55, 0.2


def lane_change(t: float) -> dict[str, float]:
    """The trajectory at time t [s]: y = A (tau - sin tau) over x = v t until tau = 2 pi, then straight on."""
    tau = min(max(_PULSATION * (t - _START), 0.0), 6.283185307179586)
    slope = _AMPLITUDE * _PULSATION * (1.0 - cos(tau))
    bend = _AMPLITUDE * _PULSATION**2 * sin(tau)
    speed = hypot(_SPEED, slope)
    return {
        "x": _SPEED * t,
        "y": _AMPLITUDE * (tau - sin(tau)),
        "course": atan2(slope, _SPEED),
        "speed": speed,
        "acceleration": slope * bend / speed,
        "curvature": _SPEED * bend / speed**3,
    }


def lane_change_bus(t: float) -> dict[str, float]:
    """The trajectory bus of the lane change at time t [s]."""
    now = lane_change(t)
    values = {f"reference.{name}": value for name, value in now.items()}
    for k in range(1, PREVIEW + 1):
        ahead = lane_change(t + k * PREVIEW_PERIOD)
        values |= {f"preview[{k}].{name}": value for name, value in ahead.items()}
    return values | {"reference.yaw_rate": now["speed"] * now["curvature"]}


def car_beside(t: float) -> dict[str, float]:
    """The trajectory bus, and a car with the reference's course 0.2 m to its left, at time t [s]."""
    now = lane_change(t)
    return lane_change_bus(t) | {
        "estimate.position.x": now["x"],
        "estimate.position.y": now["y"] + _OFFSET,
        "estimate.yaw": now["course"],
        "estimate.velocity.x": now["speed"],
    }


RUN = ReferenceRun(
    "The reference is a lane change to the left at 25 m/s. The car is told to drive 0.2 m beside it without sideslip"
    " and does not answer: what is seen is the feed-forward, and a feedback that grows with its integral.",
    stop=4.0,
    step=0.02,
    inputs=car_beside,
    plots={
        "Error across the path": ("error.lateral",),
        "Yaw rate": ("command.yaw_rate", "feedforward.yaw_rate", "feedback.yaw_rate"),
        "Steering feed-forward": ("command.steer_feedforward",),
        "Acceleration": ("command.acceleration", "feedback.acceleration"),
    },
)
