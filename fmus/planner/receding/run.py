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
from .layout import AHEAD, HORIZON, PERIOD, SUBSTEPS
from .memory import CAPACITY, PLANNING, Record, RollingPlan
from .replan import restarted
from .search import OPTIONS, Tools, tools
from .speed import SLOWEST, profile

Values = Mapping[str, Any]
Column = NDArray[np.float64]
_PREVIEW = (AHEAD - 1) * PERIOD
_STABLE = 2.78
"""Largest product of damping and step for which the Runge-Kutta method of order four is stable."""
_LEEWAY = 0.8
"""The car is faster than the profile where it cuts curves (engineering choice)."""


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
    _check_speeds(p, way)
    most = p["limit.speed"] * (_PREVIEW + 2 * p["sample_period"]) / way.spacing + 2 * tools.horizon + 2
    if most > CAPACITY:
        raise ValueError(
            f"a plan may need {most:.0f} nodes, but there is room for {CAPACITY}; "
            "give a larger road.spacing, a smaller limit.speed or a shorter sample_period"
        )


def _check_speeds(p: Values, way: road.GatedRoad) -> None:
    """Raise ValueError where the road is too slow for its gates: the integration between them would not be stable.

    The yaw motion dies out with (l_F^2 C_F + l_R^2 C_R)/(I_zz v) [1/s]; a substep takes spacing/(SUBSTEPS v).
    """
    arm = [p[f"design.geometry.{axle}_axle"] for axle in ("front", "rear")]
    stiffness = [
        np.prod([p[f"design.tyre.{axle}.{name}"] for name in ("stiffness_factor", "shape_factor", "peak")])
        for axle in ("front", "rear")
    ]
    damping = sum(a**2 * c for a, c in zip(arm, stiffness, strict=True)) / p["design.body.inertia.z"]
    per_metre = _LEEWAY * damping / (_STABLE * SUBSTEPS)
    v = profile(way.curvature, way.spacing, p["speed.lateral"], p["speed.braking"], p["end.speed"])
    k = int(np.argmin(v))
    if v[k] ** 2 < per_metre * way.spacing:
        raise ValueError(
            f"{k * way.spacing:.0f} m along it the road is driven at about {v[k]:.1f} m/s, too slow for gates "
            f"{way.spacing:.1f} m apart; give a road.spacing of at most {v[k] ** 2 / per_metre:.1f} m"
        )
    horizon = way.spacing * HORIZON
    if p["road.sight"] < horizon + way.spacing * per_metre / (2 * p["speed.braking"]):
        raise ValueError(
            f"road.sight = {p['road.sight']:g} m is too short for a horizon of {horizon:.0f} m; give a longer one"
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
        "plan.distance": plan.gate * way.spacing,
        "plan.final_time": record.final_time,
    }
