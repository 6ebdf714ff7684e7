"""`plan`: the time-optimal motion of a car along a road, by direct multiple shooting and IPOPT."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any, Literal, Protocol

import numpy as np

from fmus.planner import check, compiled, gate_grid, guess, time_grid
from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends, Nodes, Program, standing_ends
from fmus.planner.road import Corridor
from fmus.planner.vehicle import Vehicle

Grid = Literal["gate", "time"]


class Road(Protocol):
    """What a plan needs of a road."""

    def gates(self, m: int) -> Gates:
        """m + 1 gates along it."""

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which points (n, 2) leave it."""


@dataclass(frozen=True, slots=True)
class Settings:
    """How to plan: `substeps` of the integrator per interval, weight of the input changes, search limits."""

    grid: Grid = "gate"
    substeps: int = 2
    smoothing: float = 1e-4
    compile: bool = True
    max_iterations: int = 1000
    tolerance: float = 1e-8


@dataclass(frozen=True, slots=True)
class Plan:
    """A time-optimal motion and how it was found.

    `violation` [m]: of the road, on a grid ten times finer than the nodes, where alone it is enforced.
    `how`: compiled, or interpreted and why; `build_time`, `solve_time` [s].
    """

    vehicle: Vehicle
    nodes: Nodes
    substeps: int
    status: str
    iterations: int
    build_time: float
    solve_time: float
    how: str
    violation: float

    @property
    def final_time(self) -> float:
        """[s]."""
        return float(self.nodes.times[-1])

    def replay_error(self, *, restart: bool = False) -> float:
        """Largest position error [m] of a replay by an independent integrator; see `check.replay`."""
        return check.replay(self.vehicle, self.nodes, restart=restart)


def plan(
    vehicle: Vehicle,
    road: Road,
    m: int,
    ends: Ends | None = None,
    settings: Settings | None = None,
    *,
    start: Nodes | None = None,
) -> Plan:
    """The plan on m intervals; `start` (any number of intervals) is where the search begins.

    Raises PlanningError when the road, the ends or the search leave none.
    """
    ends, settings = ends or standing_ends(), settings or Settings()
    if m < 2:
        raise PlanningError(f"a plan needs at least 2 intervals, not {m}")
    gates = road.gates(m)
    _check_ends(vehicle, gates, ends)
    program = _program(vehicle, road, gates, ends, settings)
    first = guess.along_gates(vehicle, gates, ends) if start is None else guess.refined(start, m)
    if settings.grid == "time":
        first = guess.on_equal_times(first)
    return _solve(program, road, first, settings, warm=start is not None)


def refine(
    vehicle: Vehicle, road: Road, meshes: tuple[int, ...], ends: Ends | None = None, settings: Settings | None = None
) -> list[Plan]:
    """Plans on finer and finer meshes, each beginning at the one before."""
    plans: list[Plan] = []
    for m in meshes:
        plans.append(plan(vehicle, road, m, ends, settings, start=plans[-1].nodes if plans else None))
    return plans


def _program(vehicle: Vehicle, road: Road, gates: Gates, ends: Ends, settings: Settings) -> Program:
    if settings.grid == "gate":
        return gate_grid.program(vehicle, gates, ends, substeps=settings.substeps, smoothing=settings.smoothing)
    if not isinstance(road, Corridor):
        raise PlanningError("the time grid needs a road given as limits y(x); use the gate grid for a centre line")
    m = len(gates.frames) - 1
    return time_grid.program(vehicle, road, m, ends, substeps=settings.substeps, smoothing=settings.smoothing)


def _solve(program: Program, road: Road, first: Nodes, settings: Settings, *, warm: bool) -> Plan:
    solver = compiled.solver(program, _options(settings, warm=warm), compile_=settings.compile)
    before = perf_counter()
    found = solver.call(
        x0=program.pack(first),
        lbx=program.lower,
        ubx=program.upper,
        lbg=program.g_lower,
        ubg=program.g_upper,
        p=program.parameters,
    )
    seconds, stats = perf_counter() - before, solver.call.stats()
    _check_status(stats)
    nodes = program.unpack(found["x"].full().ravel())
    points = check.fine(program.vehicle, nodes, settings.substeps)[1][:2].T
    return Plan(
        vehicle=program.vehicle,
        nodes=nodes,
        substeps=settings.substeps,
        status=str(stats["return_status"]),
        iterations=int(stats["iter_count"]),
        build_time=solver.build_time,
        solve_time=seconds,
        how=solver.how,
        violation=road.violation(points),
    )


def _options(settings: Settings, *, warm: bool) -> dict[str, Any]:
    ipopt: dict[str, Any] = {
        "max_iter": settings.max_iterations,
        "tol": settings.tolerance,
        "mu_strategy": "adaptive",
        "print_level": 0,
        "sb": "yes",
    }
    if warm:
        ipopt |= {"warm_start_init_point": "yes", "mu_init": 1e-2}
    return {"ipopt": ipopt, "print_time": False, "calc_lam_p": False, "error_on_fail": False}


def _check_ends(vehicle: Vehicle, gates: Gates, ends: Ends) -> None:
    """The prescribed parts of both ends must be within the limits of car and road."""
    names = ("x", "lateral position", "speed", "sideslip", "heading", "yaw rate", "steering angle")
    for end, k, text in ((ends.first, 0, "start"), (ends.last, -1, "end")):
        low, high = vehicle.lower.copy(), vehicle.upper.copy()
        low[1], high[1] = gates.low[k], gates.high[k]
        for name, value, least, most in zip(names, end, low, high, strict=True):
            if np.isinf(value) or not (np.isnan(value) or least <= value <= most):
                raise PlanningError(f"the {name} at the {text} is {value:g}; it must be in [{least:g}, {most:g}]")


def _check_status(stats: dict[str, Any]) -> None:
    if stats["success"]:
        return
    status, count = stats["return_status"], stats["iter_count"]
    if status in ("Infeasible_Problem_Detected", "Restoration_Failed"):
        raise PlanningError(
            f"no motion of this car follows this road (IPOPT: {status} after {count} iterations); "
            "start slower, widen the road or allow more force"
        )
    raise PlanningError(f"the search ended without a plan (IPOPT: {status} after {count} iterations); use another mesh")
