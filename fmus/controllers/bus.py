"""The trajectory bus: what every source of trajectories gives and every tracking controller takes."""

from __future__ import annotations

from collections.abc import Callable

from fmukit.interface import Variable

PREVIEW = 60
PREVIEW_PERIOD = 0.05

_SAMPLE = (
    ("x", "m", "world position east of O1"),
    ("y", "m", "world position north of O1"),
    ("course", "rad", "course angle of the path, continuous (not wrapped)"),
    ("speed", "m/s", "speed along the path"),
    ("acceleration", "m/s2", "tangential acceleration"),
    ("curvature", "1/m", "curvature of the path, positive to the left"),
)
SAMPLE = tuple(name for name, _, _ in _SAMPLE)
REFERENCE = (*SAMPLE, "yaw_rate")


def trajectory_bus(make: Callable[..., Variable]) -> list[Variable]:
    """The bus as ports made by `input_` or `output`: the reference now, then PREVIEW samples PREVIEW_PERIOD apart."""
    now = [make(f"reference.{name}", unit, f"reference now: {text}") for name, unit, text in _SAMPLE]
    now.append(make("reference.yaw_rate", "rad/s", "reference now: rate of the course angle"))
    ahead = [
        make(f"preview[{k}].{name}", unit, f"reference {1000 * PREVIEW_PERIOD * k:.0f} ms ahead: {text}")
        for k in range(1, PREVIEW + 1)
        for name, unit, text in _SAMPLE
    ]
    return now + ahead
