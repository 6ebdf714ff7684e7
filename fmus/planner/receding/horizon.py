"""The receding horizon: one local problem after the other, each beginning where the accepted part of the last ends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np

from ..gates import Gates
from . import limits
from .guess import guess
from .layout import AHEAD, LONG
from .memory import BRAKED, ENDED, PLANNING, RollingPlan, Tail
from .road import GatedRoad
from .search import Ahead, Array, LocalSolution, Tools, constants, search
from .speed import SLOWEST, profile, within_horizon

TAIL, SOFT, BRAKE = 1, 2, 3
"""Fallbacks: the rest of the last problem, a softened problem, braking to a stop."""
_SETTLED = np.array([0.01, 0.02, 0.01, 0.01])
"""Sideslip [rad], yaw rate [rad/s], steering angle and course to the road [rad] of a car that goes straight on."""
_SLOWER = (1.0, 0.8, 0.6)
"""Parts of the last speed to search with: close to its limit some searches do not end."""
_ROUNDED = 1e-6
"""[m]."""
NO_TAIL = Tail(np.zeros((0, 7)), np.zeros((0, 3)), np.zeros(0))


def planned_until(tools: Tools, p: Mapping[str, Any], road: GatedRoad, plan: RollingPlan, t: float) -> RollingPlan:
    """The plan, extended until it reaches time t [s] or is complete."""
    while plan.phase == PLANNING and plan.end < t:
        plan = extended(tools, p, road, plan)
    return plan


def extended(tools: Tools, p: Mapping[str, Any], road: GatedRoad, plan: RollingPlan) -> RollingPlan:
    """The plan with the accepted part of one more local problem, or with what stands in for it."""
    ahead = problem(tools.horizon, p, road, plan)
    found = _hard(tools, p, ahead, plan.tail)
    plan = _noted(plan, found, failed=not found.solved)
    if found.solved:
        return _accepted(p, road, plan, found)
    if len(plan.tail.T):
        return _fallen_back(_continued(road, plan), TAIL)
    softened = search(tools, p, ahead, guess(ahead, NO_TAIL, 0.0), soft=True)
    plan = _noted(plan, softened, failed=False)
    if softened.solved:
        return _fallen_back(_accepted(p, road, plan, softened), SOFT)
    return _fallen_back(replace(plan, phase=BRAKED, bend=_bend(tools, p, plan)), BRAKE)


def problem(horizon: int, p: Mapping[str, Any], road: GatedRoad, plan: RollingPlan) -> Ahead:
    """The local problem at the end of the plan."""
    gates = road.gates(plan.gate, horizon + 1)
    frames = gates.frames.copy()
    frames[0, :2] = plan.x[-1, :2]
    return Ahead(
        plan.x[-1],
        plan.u[-1],
        Gates(frames, gates.low, gates.high),
        fastest(horizon, p, road, plan.gate),
        road.curvatures(plan.gate, horizon + 1),
    )


def fastest(horizon: int, p: Mapping[str, Any], road: GatedRoad, gate: int) -> Array:
    """Bounds (N+1,) of the speed [m/s]: the last from all of the road in sight, that of the next start by its horizon.

    Where the sight ends the car must be able to crawl, at the end of the road the speed is at most `end.speed`.
    """
    accept, braking = int(p["horizon.accept"]), limits.braking(p)
    seen = max(_in_sight(road, gate, p["road.sight"]), horizon) + 1
    left = max(road.last - gate + 1, 1)
    ends = not road.closed and left <= seen
    count = left if ends else seen
    end = p["end.speed"] if ends else SLOWEST
    at = road.distances(gate, max(count, horizon + accept + 1))
    v = profile(road.curvatures(gate, count), np.diff(at[:count]), limits.lateral(p), braking, end)
    v = np.concatenate([v, np.full(max(horizon + accept + 1 - count, 0), v[-1])])
    bounds = np.full(horizon + 1, p["limit.speed"])
    if ends:
        bounds[left - 1 :] = np.minimum(bounds[left - 1 :], end)
    if horizon < LONG:  # else what is left of the problem, and the profile beyond it, are a way for the next one
        next_start = within_horizon(v[horizon + accept], at[horizon + accept] - at[accept], braking)
        bounds[accept] = min(bounds[accept], next_start)
    bounds[horizon] = min(bounds[horizon], v[horizon])
    return bounds


def _in_sight(road: GatedRoad, gate: int, sight: float) -> int:
    """Gates within `sight` [m] after the gate."""
    most = len(road.at) if not road.closed else road.last * (1 + int(sight / road.at[-1])) + 1
    away = road.distances(gate, most) - road.distances(gate, 1)[0]
    return int(np.searchsorted(away, sight + _ROUNDED, side="right")) - 1


def _hard(tools: Tools, p: Mapping[str, Any], ahead: Ahead, tail: Tail) -> LocalSolution:
    """The problem as it is; else once more from the road, and then to slower ends, whose solutions serve as well.

    Iterations and times are those of all searches.
    """
    tails = (tail, NO_TAIL) if len(tail.T) else (NO_TAIL,)
    iterations, time = 0, 0.0
    for part, begin in product(_SLOWER, tails):
        way = replace(ahead, fastest=np.append(ahead.fastest[:-1], part * ahead.fastest[-1]))
        found = search(tools, p, way, guess(way, begin, 0.2 * p["limit.rear_drive"]))
        iterations, time = iterations + found.iterations, time + found.time
        if found.solved:
            break
    return replace(found, iterations=iterations, time=time)


def _accepted(p: Mapping[str, Any], road: GatedRoad, plan: RollingPlan, found: LocalSolution) -> RollingPlan:
    """With the first M intervals, or with all up to the end of the road and until the car goes straight on."""
    nodes, k = found.nodes, int(p["horizon.accept"])
    left = road.last - plan.gate
    ends = not road.closed and left <= k
    if ends:
        course = nodes.x[:, 3] + nodes.x[:, 4] - road.frames[-1, 2]
        straight = np.all(np.abs(np.column_stack([nodes.x[:, [3, 5, 6]], course])) <= _SETTLED, axis=1)
        settled = [j for j in range(max(left, 1), len(nodes.T)) if straight[j]]
        k = settled[0] if settled else len(nodes.T)
    tail = Tail(nodes.x[k + 1 :], nodes.u[k:], nodes.T[k:])
    plan = replace(_joined(road, plan, Tail(nodes.x[1 : k + 1], nodes.u[:k], nodes.T[:k])), tail=tail)
    return replace(plan, phase=ENDED) if ends else plan


def _continued(road: GatedRoad, plan: RollingPlan) -> RollingPlan:
    """With the rest of the last problem, which is then used up."""
    plan = replace(_joined(road, plan, plan.tail), tail=NO_TAIL)
    ends = not road.closed and plan.gate >= road.last
    return replace(plan, phase=ENDED) if ends else plan


def _joined(road: GatedRoad, plan: RollingPlan, part: Tail) -> RollingPlan:
    """With the part; passing the last gate of the road is noted."""
    longer = plan.joined(part.x, part.u, part.T)
    passed = [k for k in range(1, len(part.T) + 1) if _at_end(road, plan.gate + k)]
    if not passed:
        return longer
    time = float(longer.times[len(plan.times) - 1 + passed[-1]])
    return replace(longer, record=replace(longer.record, final_time=time))


def _at_end(road: GatedRoad, gate: int) -> bool:
    return gate % road.last == 0 if road.closed else gate == road.last


def _noted(plan: RollingPlan, found: LocalSolution, *, failed: bool) -> RollingPlan:
    record = replace(
        plan.record,
        count=plan.record.count + 1,
        failed=plan.record.failed + failed,
        status=found.status,
        iterations=found.iterations,
        time=found.time,
        violation=found.violation,
        slack=found.slack,
    )
    return replace(plan, record=record)


def _fallen_back(plan: RollingPlan, kind: int) -> RollingPlan:
    return replace(plan, record=replace(plan.record, fallbacks=plan.record.fallbacks + 1, fallback=kind))


def _bend(tools: Tools, p: Mapping[str, Any], plan: RollingPlan) -> float:
    """Curvature [1/m] of the path at the end of the plan."""
    columns = (np.tile(part[:, None], AHEAD) for part in (plan.x[-1], plan.u[-1]))
    return float(tools.motion(*columns, np.zeros((1, AHEAD)), constants(p))[8, 0])
