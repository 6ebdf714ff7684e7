"""A plan begun anew at the estimated state, when the car is too far from where the plan has it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .memory import RollingPlan
from .road import GatedRoad
from .speed import SLOWEST

Array = NDArray[np.float64]
_AHEAD = 0.5
"""The first gate of the new plan is ahead of the car by at least this part of the spacing."""


def restarted(
    p: Mapping[str, Any], u: Mapping[str, float], road: GatedRoad, plan: RollingPlan, now: Array, t: float
) -> RollingPlan:
    """The plan, or one that begins at the estimate; `now` (7,) is the planned state at time t [s].

    The steering angle is the planned one.
    """
    x, y, yaw = u["estimate.position.x"], u["estimate.position.y"], u["estimate.yaw"]
    if np.hypot(x - now[0], y - now[1]) <= p["replan.distance"]:
        return plan
    v_x, v_y = u["estimate.velocity.x"], u["estimate.velocity.y"]
    v = float(np.clip(np.hypot(v_x, v_y), SLOWEST, p["limit.speed"]))
    near = now[4] + np.arctan2(np.sin(yaw - now[4]), np.cos(yaw - now[4]))
    state = np.array([x, y, v, np.arctan2(v_y, max(v_x, SLOWEST)), near, u["estimate.yaw_rate"], now[6]])
    gate = gate_before(road, plan, state)
    record = replace(plan.record, replans=plan.record.replans + 1)
    return RollingPlan(np.array([t]), state[None, :], plan.u[:1], gate, record=record)


def gate_before(road: GatedRoad, plan: RollingPlan, state: Array) -> int:
    """The gate before the first one that is ahead of the car, searched for near the gates of the plan."""
    first = plan.gate - len(plan.times) - 2
    first = first if road.closed else max(first, 0)
    count = plan.gate - first + 3
    frames = road.gates(first, count).frames
    away = frames[:, :2] - state[:2]
    ahead = np.cos(frames[:, 2]) * away[:, 0] + np.sin(frames[:, 2]) * away[:, 1]
    near = np.hypot(*away.T)
    nearest = int(np.argmin(near))
    least = _AHEAD * np.diff(road.distances(first - 1, count + 1))
    later = [k for k in range(nearest, count) if ahead[k] > least[k]]
    gate = first + (later[0] if later else count) - 1
    return gate if road.closed else max(gate, 0)
