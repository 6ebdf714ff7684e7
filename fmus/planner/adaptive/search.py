"""Searches on a mesh: the first, and one that begins at the plan on nearly the same mesh."""

from __future__ import annotations

from dataclasses import dataclass, replace

from fmus.planner import gate_grid
from fmus.planner.adaptive.mesh import Mesh
from fmus.planner.hocp import PlanSettings
from fmus.planner.program import Ends, Nodes, NonlinearProgram
from fmus.planner.search import Solution, again_options, ipopt_options, search
from fmus.planner.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class Found:
    """A solution and its mesh."""

    mesh: Mesh
    solution: Solution


def on_mesh(vehicle: Vehicle, made: Mesh, ends: Ends, settings: PlanSettings, first: Nodes) -> Found:
    """The plan found from `first`; raises SearchError when there is none."""
    options = ipopt_options(settings.max_iterations, settings.tolerance, warm=False)
    return Found(made, search(_program(vehicle, made, ends, settings), first, options, compile_=settings.compile))


def again(vehicle: Vehicle, made: Mesh, ends: Ends, settings: PlanSettings, before: Found) -> Found:
    """The same from the plan `before` and its multipliers, with its iterations and times added."""
    program, old = _program(vehicle, made, ends, settings), before.solution
    options = again_options(settings.max_iterations, settings.tolerance)
    new = search(program, old.nodes, options, compile_=settings.compile, multipliers=old.multipliers)
    total = replace(
        new,
        iterations=old.iterations + new.iterations,
        build_time=old.build_time + new.build_time,
        solve_time=old.solve_time + new.solve_time,
    )
    return Found(made, total)


def _program(vehicle: Vehicle, made: Mesh, ends: Ends, settings: PlanSettings) -> NonlinearProgram:
    return gate_grid.program(vehicle, made.gates, ends, substeps=made.substeps, smoothing=settings.smoothing)
