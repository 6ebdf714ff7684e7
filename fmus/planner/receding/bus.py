"""The plan as the trajectory bus: now and every 50 ms ahead."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import limits
from .layout import AHEAD, PERIOD
from .memory import BRAKED, RollingPlan
from .search import Tools, constants

Array = NDArray[np.float64]
_SAMPLE = ("x", "y", "course", "speed", "acceleration", "curvature")


def outputs(tools: Tools, p: Mapping[str, Any], plan: RollingPlan, t: float) -> dict[str, float]:
    """`reference.*` at time t [s] and `preview[k].*` after it."""
    values = samples(tools, p, plan, np.array([t + PERIOD * k for k in range(AHEAD)])).tolist()
    named = {f"reference.{name}": value for name, value in zip(_SAMPLE, values[0], strict=True)}
    named["reference.yaw_rate"] = named["reference.speed"] * named["reference.curvature"]
    for k in range(1, AHEAD):
        named.update(zip([f"preview[{k}].{name}" for name in _SAMPLE], values[k], strict=True))
    return named


def samples(tools: Tools, p: Mapping[str, Any], plan: RollingPlan, times: Array) -> Array:
    """(AHEAD, 6): x, y, course, speed, acceleration and curvature at the times (AHEAD,) [s], none before the plan."""
    moved = states(tools, p, plan, times)
    course = moved[:, 3] + moved[:, 4]
    inside = np.column_stack([moved[:, :2], course, moved[:, 2], moved[:, 7:]])
    x = plan.x[-1]
    rate, bend = (limits.braking(p), plan.bend) if plan.phase == BRAKED else (p["end.deceleration"], 0.0)
    outside = onward(np.array([x[0], x[1], x[3] + x[4], x[2]]), rate, bend, np.maximum(times - plan.end, 0.0))
    return np.where((times < plan.end)[:, None], inside, outside)


def states(tools: Tools, p: Mapping[str, Any], plan: RollingPlan, times: Array) -> Array:
    """(AHEAD, 9): states, acceleration [m/s2] and curvature [1/m] at times (AHEAD,) [s]; held after the plan's end."""
    k = np.clip(np.searchsorted(plan.times, times, side="right") - 1, 0, max(len(plan.times) - 2, 0))
    since = np.minimum(times, plan.end) - plan.times[k]
    return np.asarray(tools.motion(plan.x[k].T, plan.u[k].T, since[None, :], constants(p)).full()).T


def onward(start: Array, rate: float, bend: float, t: Array) -> Array:
    """(n, 6) after t (n,) [s] from x, y, course, speed: braking by `rate` [m/s2] to a stop on the curvature `bend`."""
    x, y, course, v = start
    moving = t if rate == 0 else np.minimum(t, v / rate)
    s = v * moving - 0.5 * rate * moving**2
    speed, chord = np.maximum(v - rate * moving, 0.0), s * np.sinc(bend * s / 2 / np.pi)
    middle = course + bend * s / 2
    slowing = np.where(speed > 0, -rate, 0.0)
    columns = x + chord * np.cos(middle), y + chord * np.sin(middle), course + bend * s, speed, slowing
    return np.column_stack([*columns, np.full(len(t), bend)])
