"""The receding horizon along a whole road at once, outside an FMU: for tests, comparisons and benchmarks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from fmukit.compiling.compiler import host_platform
from fmukit.compiling.functions import library
from fmus.cars.single_track import single_track_car
from fmus.planner.program import Nodes
from fmus.planner.receding import horizon, road, run
from fmus.planner.receding.interface import INTERFACE
from fmus.planner.receding.layout import CAR, HORIZON
from fmus.planner.receding.local import motion, problem
from fmus.planner.receding.memory import PLANNING, Record, RollingPlan
from fmus.planner.receding.model import kernel
from fmus.planner.receding.search import OPTIONS, Tools, tools
from fmus.planner.vehicle import Vehicle, two_wheel_drive


@dataclass(frozen=True, slots=True)
class WholePlan:
    """The whole plan, and the record after each local problem."""

    plan: RollingPlan
    records: tuple[Record, ...]

    @property
    def final_time(self) -> float:
        """Time of passing the end of the road [s]; 0 when it was not reached."""
        return self.plan.record.final_time

    @property
    def nodes(self) -> Nodes:
        """The plan in the form of the offline planner."""
        plan = self.plan
        return Nodes(plan.x.T, plan.u[:-1].T, plan.times[1:] - plan.times[:-1])


def parameters(overrides: Mapping[str, Any] | None = None) -> dict[str, Any]:
    """Start values of the FMU with `overrides`; unknown names raise KeyError."""
    start: dict[str, Any] = {variable.name: variable.start for variable in INTERFACE.select("parameter")}
    unknown = (overrides or {}).keys() - start.keys()
    if unknown:
        raise KeyError(f"{INTERFACE.name} has no parameter {', '.join(sorted(unknown))}")
    return start | dict(overrides or {})


def compiled(horizon: int = HORIZON) -> Tools:
    """Solver and motion as they are in the FMU, from the cache or compiled now (half a minute)."""
    made = kernel((horizon,))
    names = made.libraries
    return run.prepare({name: str(library(names[name], name, host_platform())) for name in names})[horizon]


def interpreted(horizon: int = HORIZON) -> Tools:
    """Solver and motion evaluated by CasADi's virtual machine."""
    local = problem(horizon)
    return tools(ca.nlpsol("local", "ipopt", local.nlp, OPTIONS | local.derivatives), motion())


def drive(
    tools: Tools, p: Mapping[str, Any], table: Sequence[Sequence[float]] = (), most: int = 1000, *, lap: bool = False
) -> WholePlan:
    """One local problem after the other to the end of an open road, `most` of them at most.

    With `lap` until the start of a closed road is passed.
    """
    way = road.read(p, table)
    plan = run.start(p, way)
    records: list[Record] = []
    while plan.phase == PLANNING and len(records) < most and not (lap and plan.record.final_time):
        plan = horizon.extended(tools, p, way, plan)
        records.append(plan.record)
    return WholePlan(plan, tuple(records))


def same_limits(p: Mapping[str, Any]) -> Vehicle:
    """The car and the limits of `p` for the offline planner."""
    vehicle = two_wheel_drive(
        single_track_car({**{name: p[f"design.{name}"] for name in CAR}, "wheel.radius": 0.0}),
        friction=p["tyre.friction"] if p["tyre.combined_slip"] else None,
        steering_rate=p["limit.steering_rate"],
        front=(-p["limit.front_brake"], 0.0),
        rear=(-p["limit.rear_brake"], p["limit.rear_drive"]),
    )
    low, high = vehicle.lower.copy(), vehicle.upper.copy()
    high[[2, 3, 6]] = p["limit.speed"], p["limit.sideslip"], p["limit.steering_angle"]
    low[[3, 6]] = -high[[3, 6]]
    return replace(vehicle, lower=low, upper=high)
