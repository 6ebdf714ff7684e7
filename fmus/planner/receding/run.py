"""RecedingHorizonPlanner at run time: travels inside the FMU with the modules it imports. See fmukit/python_kernel.py.

It imports nothing of ours by its full name: equations are in the compiled libraries only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from . import memory, road
from .bus import outputs, states
from .horizon import planned_until
from .layout import AHEAD, PERIOD
from .memory import CAPACITY, PLANNING, Plan, Record
from .replan import restarted
from .search import OPTIONS, Tools, tools
from .speed import SLOWEST

Values = Mapping[str, Any]
Column = NDArray[np.float64]
_PREVIEW = (AHEAD - 1) * PERIOD


def prepare(libraries: Mapping[str, str]) -> Tools:
    """The solver and the motion of the compiled libraries."""
    return tools(ca.nlpsol("local", "ipopt", libraries["local"], OPTIONS), ca.external("motion", libraries["motion"]))


def initialise(
    tools: Tools, p: Values, u: Values, table: Sequence[Sequence[float]]
) -> tuple[Column, Column, dict[str, float]]:
    """The road as derived numbers, the first plan as states, and its outputs."""
    way = road.read(p, table)
    _check(tools, p, way)
    plan = _planned(tools, p, way, start(p, way), 0.0)
    return road.to_numbers(way), memory.to_numbers(plan, tools.horizon), _outputs(tools, p, way, plan, 0.0)


def sample(
    tools: Tools, p: Values, d: Sequence[float], u: Values, x: Sequence[float], t: float
) -> tuple[Column, dict[str, float]]:
    """The plan at time t [s], extended when the preview would reach beyond it."""
    way, plan = road.from_numbers(d), memory.from_numbers(x, tools.horizon)
    if p["replan.from_estimate"] and plan.phase == PLANNING:
        now = states(tools, p, plan, np.full(AHEAD, t))[0, : plan.x.shape[1]]
        plan = restarted(p, u, way, plan, now, t)
    plan = _planned(tools, p, way, plan, t)
    return memory.to_numbers(plan, tools.horizon), _outputs(tools, p, way, plan, t)


def _planned(tools: Tools, p: Values, way: road.Road, plan: Plan, t: float) -> Plan:
    """Always one sample more than the preview needs."""
    return planned_until(tools, p, way, plan.since(t), t + _PREVIEW + p["sample_period"])


def start(p: Values, way: road.Road) -> Plan:
    """The car on the first gate; raises ValueError when it is not within the limits there."""
    x, y, heading = way.frames[0]
    side, turn = p["initial.lateral"], p["initial.heading"]
    if not way.low[0] <= side <= way.high[0]:
        raise ValueError(
            f"initial.lateral = {side:g} m leaves the road, whose first gate allows "
            f"[{way.low[0]:g}, {way.high[0]:g}] m; start closer to its middle"
        )
    state = [x - side * np.sin(heading), y + side * np.cos(heading), p["initial.speed"], 0.0, heading + turn, 0.0, 0.0]
    return Plan(np.zeros(1), np.array([state]), np.zeros((1, 3)), 0, record=Record())


def _check(tools: Tools, p: Values, way: road.Road) -> None:
    """Raise ValueError when the parameters do not go together."""
    if not SLOWEST <= p["initial.speed"] <= p["limit.speed"]:
        raise ValueError(
            f"initial.speed = {p['initial.speed']:g} m/s is outside [{SLOWEST:g}, limit.speed = {p['limit.speed']:g}]"
        )
    if p["horizon.accept"] > tools.horizon or p["horizon.accept"] != int(p["horizon.accept"]):
        raise ValueError(f"horizon.accept = {p['horizon.accept']:g} must be a whole number up to {tools.horizon}")
    most = p["limit.speed"] * (_PREVIEW + 2 * p["sample_period"]) / way.spacing + 2 * tools.horizon + 2
    if most > CAPACITY:
        raise ValueError(
            f"a plan may need {most:.0f} nodes, but there is room for {CAPACITY}; "
            "give a larger road.spacing, a smaller limit.speed or a shorter sample_period"
        )


def _outputs(tools: Tools, p: Values, way: road.Road, plan: Plan, t: float) -> dict[str, float]:
    record = plan.record
    return {
        **outputs(tools, p, plan, t),
        "solver.status": record.status,
        "solver.iterations": record.iterations,
        "solver.time": record.time,
        "solver.violation": record.violation,
        "solver.slack": record.slack,
        "problem.count": record.count,
        "problem.failed": record.failed,
        "fallback.count": record.fallbacks,
        "fallback.kind": record.fallback,
        "replan.count": record.replans,
        "plan.phase": plan.phase,
        "plan.end_time": plan.end,
        "plan.distance": plan.gate * way.spacing,
        "plan.final_time": record.final_time,
    }
