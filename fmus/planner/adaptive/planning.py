"""`plan`: the time-optimal motion along a road, open or closed, on a mesh that follows the road and the plan."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from fmus.planner.adaptive import guess, repair, search
from fmus.planner.adaptive.line import Line, smooth_line
from fmus.planner.adaptive.mesh import Mesh, mesh
from fmus.planner.adaptive.search import Found
from fmus.planner.adaptive.speed import profile
from fmus.planner.bends import check_bends
from fmus.planner.diagnosis import check_ends, ends_instead
from fmus.planner.errors import PlanningError, SearchError
from fmus.planner.frames import into_frames
from fmus.planner.gates import Array, check_widths, checked
from fmus.planner.hocp import Plan, PlanSettings
from fmus.planner.path_road import PathRoad
from fmus.planner.program import Ends, standing_ends
from fmus.planner.vehicle import Vehicle

_COARSE, _FINE = (0.6, 8), (1.5, 4)
"""Fineness and substeps of the meshes on which a search is repeated: from a plan on the coarse one on the fine one."""
_WIDER = 1.0
"""By so much [m] a road is widened to either side to see whether its width is the matter."""
_REMEDY_ITERATIONS = 200
"""A plan with freer ends or on a wider road is found within so many, or is not worth waiting for."""


@dataclass(frozen=True, slots=True)
class _Task:
    """A car, a road, the ends and the settings; `line` and `v` (n,) [m/s] are what meshes and guesses are made of."""

    vehicle: Vehicle
    road: PathRoad
    ends: Ends
    settings: PlanSettings
    line: Line
    v: Array
    least: int

    def mesh(self, finer: float, substeps: int, least: int = 0) -> Mesh:
        """A mesh on which a car fits through every gate."""
        made = mesh(self.line, self.v, finer, substeps, max(least, self.least))
        checked(made.gates)
        return made

    def found(self, made: Mesh, before: Found | None = None) -> Found:
        """What the search finds from the plan `before`, else from the profile; raises SearchError."""
        first = guess.along(self.vehicle, made, self.v) if before is None else guess.moved(before, made)
        return search.on_mesh(self.vehicle, made, self.ends, self.settings, first)


def plan(
    vehicle: Vehicle,
    road: PathRoad,
    ends: Ends | None = None,
    settings: PlanSettings | None = None,
    least: int = 0,
) -> Plan:
    """The plan on at least `least` intervals; on a closed road the periodic flying lap, for which there are no `ends`.

    Raises PlanningError when the road, the ends or the searches leave none.
    """
    settings = settings or PlanSettings()
    ends = _any_ends() if road.closed else ends or standing_ends()
    task = _task(vehicle, road, ends, settings, least)
    made = task.mesh(1.0, settings.substeps)
    check_ends(vehicle, made.gates, ends)
    check_bends(vehicle, made.gates)
    try:
        return _plan(task, _repaired(task, _searched(task, made)))
    except SearchError as failure:
        raise _blamed(task, made, failure) from None


def _any_ends() -> Ends:
    """Any state on the first and on the last gate."""
    end = np.full(7, np.nan)
    end[0] = 0.0
    return Ends(end, end.copy())


def _task(vehicle: Vehicle, road: PathRoad, ends: Ends, settings: PlanSettings, least: int) -> _Task:
    check_widths(road.across())
    line = smooth_line(road)
    v = profile(line.s, line.curvature, vehicle.upper[2], ends.first[2], closed=line.closed)
    return _Task(vehicle, road, ends, settings, line, np.clip(v, vehicle.lower[2], None), least)


def _searched(task: _Task, made: Mesh) -> Found:
    """The plan on the mesh, or on a finer one begun at that of a coarse one."""
    try:
        return task.found(made)
    except SearchError as error:
        failure = error
    coarse: Found | None = None
    with suppress(SearchError):
        coarse = task.found(task.mesh(*_COARSE))
    fine = task.mesh(*_FINE, made.intervals + 1)
    try:
        return task.found(fine, coarse)
    except SearchError as again:
        if coarse is not None:
            return coarse
        tried = f"{failure.status}, on {made.intervals} and on {fine.intervals} intervals"
        raise SearchError(tried, again.iterations, _nearest(fine, made, again.interval)) from None


def _nearest(fine: Mesh, made: Mesh, interval: int) -> int:
    return int(np.searchsorted(made.at, fine.at[interval], side="right") - 1)


def _repaired(task: _Task, found: Found) -> Found:
    """Brought back onto the road where it leaves it between its gates, as far as repairs go."""
    for _ in range(repair.ROUNDS):
        excess = repair.excess(task.vehicle, task.road, found)
        if excess.max() <= repair.ALLOWED:
            break
        try:
            better = search.again(task.vehicle, repair.narrowed(found.mesh, excess), task.ends, task.settings, found)
        except SearchError:
            break
        if repair.excess(task.vehicle, task.road, better).max() >= excess.max():
            break
        found = better
    return found


def _plan(task: _Task, found: Found) -> Plan:
    solution = found.solution
    return Plan(
        vehicle=task.vehicle,
        nodes=solution.nodes,
        substeps=found.mesh.substeps,
        status=solution.status,
        iterations=solution.iterations,
        build_time=solution.build_time,
        solve_time=solution.solve_time,
        how=solution.how,
        violation=float(repair.excess(task.vehicle, task.road, found).max()),
        residual=solution.residual,
    )


def _blamed(task: _Task, made: Mesh, failure: SearchError) -> PlanningError:
    """The failure with what was shown to do instead: other ends, a wider road; else only where the searches broke."""
    limit = min(task.settings.max_iterations, _REMEDY_ITERATIONS)
    quick = replace(task, settings=replace(task.settings, max_iterations=limit))

    def remedy(other: Ends) -> Ends:
        nodes = replace(quick, ends=other).found(made).solution.nodes
        x = into_frames(nodes.x[:, [0, -1]], made.gates.frames[[0, -1]])
        return Ends(x[:, 0], x[:, 1])

    instead = failure.interval if task.road.closed else ends_instead(failure, task.ends, remedy)
    if isinstance(instead, PlanningError):
        return instead
    x, y = made.gates.frames[instead, :2]
    where = f"{failure}; it breaks near x = {x:.1f} m, y = {y:.1f} m, {made.at[instead]:.0f} m along the road"
    wider = replace(task.road, widths=task.road.widths + _WIDER)
    with suppress(SearchError, PlanningError):
        other = _task(task.vehicle, wider, task.ends, quick.settings, task.least)
        other.found(other.mesh(1.0, task.settings.substeps))
        return PlanningError(f"{where}; there is one when the road is {_WIDER:g} m wider to both sides")
    return PlanningError(f"{where}; nothing shows that the road is at fault: try more intervals, or another car")
