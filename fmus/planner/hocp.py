"""`plan`: the time-optimal motion of a car along a road, by direct multiple shooting and IPOPT."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, Protocol

import numpy as np

from fmus.planner import check, gate_grid, guess, time_grid
from fmus.planner.bends import check_bends
from fmus.planner.diagnosis import FINE, check_ends, explained
from fmus.planner.errors import PlanningError, SearchError
from fmus.planner.frames import into_frames
from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends, Nodes, NonlinearProgram, standing_ends
from fmus.planner.road import Corridor
from fmus.planner.search import Solution, ipopt_options, search
from fmus.planner.vehicle import Vehicle

Grid = Literal["gate", "time"]

_FARTHEST = 100.0
"""Largest distance of two gates [m] (engineering choice): some seconds with inputs held."""
_REMEDY_ITERATIONS = 150
"""A plan with freer ends is found within so many iterations, or is not worth waiting for (engineering choice)."""


class Road(Protocol):
    """What a plan needs of a road."""

    def gates(self, m: int) -> Gates:
        """m + 1 gates along it."""

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which points (n, 2) leave it."""


@dataclass(frozen=True, slots=True)
class PlanSettings:
    """How to plan: `substeps` of the integrator per interval, weight of the input changes, search limits."""

    grid: Grid = "gate"
    substeps: int = 2
    smoothing: float = 1e-4
    compile: bool = True
    max_iterations: int = 400
    tolerance: float = 1e-8


@dataclass(frozen=True, slots=True)
class Plan:
    """A time-optimal motion and how it was found.

    `violation` [m]: of the road, on a grid ten times finer than the nodes, where alone it is enforced.
    `residual`: largest violation of a constraint at the nodes, in scaled units.
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
    residual: float

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
    settings: PlanSettings | None = None,
    *,
    start: Nodes | None = None,
) -> Plan:
    """The plan on m intervals; `start` (any number of intervals) is where the search begins.

    Raises PlanningError when the road, the ends or the search leave none.
    """
    ends, settings = ends or standing_ends(), settings or PlanSettings()
    if m < 2:
        raise PlanningError(f"a plan needs at least 2 intervals, not {m}")
    gates = road.gates(m)
    _check_spacing(gates)
    check_ends(vehicle, gates, ends)
    check_bends(vehicle, gates)

    def attempt(limit: int, other: Ends, on: Gates) -> Solution:
        first = _guess(vehicle, on, other, settings, start)
        options = ipopt_options(limit, settings.tolerance, warm=start is not None)
        return search(_program(vehicle, road, on, other, settings), first, options, compile_=settings.compile)

    def remedy(other: Ends, on: Gates) -> Ends:
        limit = min(settings.max_iterations, _REMEDY_ITERATIONS)
        return _ends_of(attempt(limit, other, on).nodes, on)

    try:
        return _plan(vehicle, road, settings, attempt(settings.max_iterations, ends, gates))
    except SearchError as failure:
        raise explained(failure, ends, gates, remedy, road.gates(max(FINE, 2 * m))) from None


def _check_spacing(gates: Gates) -> None:
    lengths = np.hypot(*gates.steps[:, :2].T)
    if lengths.max() > _FARTHEST:
        raise PlanningError(
            f"the gates are {lengths.max():.0f} m apart, too far to plan between them; "
            f"take at least {np.ceil(lengths.sum() / _FARTHEST):.0f} intervals"
        )


def _guess(vehicle: Vehicle, gates: Gates, ends: Ends, settings: PlanSettings, start: Nodes | None) -> Nodes:
    nodes = guess.along_gates(vehicle, gates, ends) if start is None else guess.refined(start, len(gates.frames) - 1)
    return guess.on_equal_times(nodes) if settings.grid == "time" else nodes


def _plan(vehicle: Vehicle, road: Road, settings: PlanSettings, found: Solution) -> Plan:
    points = check.fine(vehicle, found.nodes, settings.substeps)[1][:2].T
    return Plan(
        vehicle=vehicle,
        nodes=found.nodes,
        substeps=settings.substeps,
        status=found.status,
        iterations=found.iterations,
        build_time=found.build_time,
        solve_time=found.solve_time,
        how=found.how,
        violation=road.violation(points),
        residual=found.residual,
    )


def _program(vehicle: Vehicle, road: Road, gates: Gates, ends: Ends, settings: PlanSettings) -> NonlinearProgram:
    if settings.grid == "gate":
        return gate_grid.program(vehicle, gates, ends, substeps=settings.substeps, smoothing=settings.smoothing)
    if not isinstance(road, Corridor):
        raise PlanningError("the time grid needs a road given as limits y(x); use the gate grid for a centre line")
    m = len(gates.frames) - 1
    return time_grid.program(vehicle, road, m, ends, substeps=settings.substeps, smoothing=settings.smoothing)


def _ends_of(nodes: Nodes, gates: Gates) -> Ends:
    """The first and the last state in the frames of their gates."""
    x = into_frames(nodes.x[:, [0, -1]], gates.frames[[0, -1]])
    return Ends(x[:, 0], x[:, 1])
