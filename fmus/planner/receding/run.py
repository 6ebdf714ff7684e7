"""RecedingHorizonPlanner at run time: travels inside the FMU with the modules it imports. See fmukit/python_kernel.py.

It imports nothing of ours by its full name: equations are in the compiled libraries only.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from . import limits, memory, road
from .bus import outputs, states
from .horizon import planned_until
from .layout import AHEAD, LONG, PERIOD
from .memory import CAPACITY, PLANNING, Record, RollingPlan
from .replan import restarted
from .search import OPTIONS, Tools, tools
from .speed import SLOWEST, profile

Values = Mapping[str, Any]
Column = NDArray[np.float64]
_PREVIEW = (AHEAD - 1) * PERIOD
_LEEWAY = 1.2
"""The car is faster than the profile where it cuts curves (engineering choice)."""
_SIGHT = 1.0
"""Gates in sight at least beyond a horizon."""


Prepared = Mapping[int, Tools]
"""By the number of intervals of their local problems."""


def prepare(libraries: Mapping[str, str]) -> Prepared:
    """The solvers and the motion of the compiled libraries."""
    motion = ca.external("motion", libraries["motion"])
    solvers = (ca.nlpsol("local", "ipopt", libraries[name], OPTIONS) for name in libraries if name != "motion")
    made = (tools(solver, motion) for solver in solvers)
    return {each.horizon: each for each in made}


def initialise(
    prepared: Prepared, p: Values, u: Values, table: Sequence[Sequence[float]]
) -> tuple[Column, Column, dict[str, float]]:
    """The road as derived numbers, the first plan as states, and its outputs."""
    way = road.read(p, table)
    tools = prepared[way.horizon]
    _check(tools, p, way)
    plan = _planned(tools, p, way, start(p, way), 0.0)
    return road.to_numbers(way), memory.to_numbers(plan, LONG), _outputs(tools, p, way, plan, 0.0)


def sample(
    prepared: Prepared, p: Values, d: Sequence[float], u: Values, x: Sequence[float], t: float
) -> tuple[Column, dict[str, float]]:
    """The plan at time t [s], extended when the preview would reach beyond it."""
    way, plan = road.from_numbers(d), memory.from_numbers(x, LONG)
    tools = prepared[way.horizon]
    if p["replan.from_estimate"] and plan.phase == PLANNING:
        now = states(tools, p, plan, np.full(AHEAD, t))[0, : plan.x.shape[1]]
        plan = restarted(p, u, way, plan, now, t)
    plan = _planned(tools, p, way, plan, t)
    return memory.to_numbers(plan, LONG), _outputs(tools, p, way, plan, t)


def _planned(tools: Tools, p: Values, way: road.GatedRoad, plan: RollingPlan, t: float) -> RollingPlan:
    """Always one sample more than the preview needs."""
    return planned_until(tools, p, way, plan.since(t), t + _PREVIEW + p["sample_period"])


def start(p: Values, way: road.GatedRoad) -> RollingPlan:
    """The car on the first gate; raises ValueError when it is not within the limits there."""
    x, y, heading = way.frames[0]
    side, turn = p["initial.lateral"], p["initial.heading"]
    if not way.low[0] <= side <= way.high[0]:
        raise ValueError(
            f"initial.lateral = {side:g} m leaves the road, whose first gate allows "
            f"[{way.low[0]:g}, {way.high[0]:g}] m; start closer to its middle"
        )
    state = [x - side * np.sin(heading), y + side * np.cos(heading), p["initial.speed"], 0.0, heading + turn, 0.0, 0.0]
    return RollingPlan(np.zeros(1), np.array([state]), np.zeros((1, 3)), 0, record=Record())


def _check(tools: Tools, p: Values, way: road.GatedRoad) -> None:
    """Raise ValueError when the parameters do not go together."""
    if not SLOWEST <= p["initial.speed"] <= p["limit.speed"]:
        raise ValueError(
            f"initial.speed = {p['initial.speed']:g} m/s is outside [{SLOWEST:g}, limit.speed = {p['limit.speed']:g}]"
        )
    if p["horizon.accept"] > tools.horizon or p["horizon.accept"] != int(p["horizon.accept"]):
        raise ValueError(f"horizon.accept = {p['horizon.accept']:g} must be a whole number up to {tools.horizon}")
    most = _gates_ahead(p, way) + 2 * tools.horizon + 2
    if most > CAPACITY:
        raise ValueError(
            f"a plan may need {most:.0f} nodes, but there is room for {CAPACITY}; "
            "give a larger road.spacing, a smaller limit.speed or a shorter sample_period"
        )
    _check_sight(p, tools.horizon)


def _gates_ahead(p: Values, way: road.GatedRoad) -> int:
    """Gates at most that the preview may reach beyond, at the speed that the road allows somewhere."""
    v = profile(way.curvature, np.diff(way.at), limits.lateral(p), limits.braking(p), p["limit.speed"])
    fastest = min(p["limit.speed"], _LEEWAY * float(v.max()))
    at = way.distances(0, 2 * way.last)
    beyond = np.searchsorted(at, way.at[:-1] + fastest * (_PREVIEW + 2 * p["sample_period"]), side="right")
    return int(np.max(beyond - np.arange(way.last)))


def _check_sight(p: Values, horizon: int) -> None:
    """Raise ValueError when the car cannot brake to a crawl on what is left of the sight beyond a horizon."""
    length = horizon * p["road.spacing"]
    if p["road.sight"] < length + _SIGHT * p["road.spacing"]:
        raise ValueError(
            f"road.sight = {p['road.sight']:g} m is too short for a horizon of {length:.0f} m; give a longer one"
        )


def _outputs(tools: Tools, p: Values, way: road.GatedRoad, plan: RollingPlan, t: float) -> dict[str, float]:
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
        "plan.distance": float(way.distances(plan.gate, 1)[0]),
        "plan.final_time": record.final_time,
    }
