"""Plans on finer and finer meshes, to see end times converge."""

from __future__ import annotations

from fmus.planner.hocp import Plan, PlanSettings, Road, plan
from fmus.planner.vehicle import Vehicle


def refine(vehicle: Vehicle, road: Road, meshes: tuple[int, ...], settings: PlanSettings) -> list[Plan]:
    """The plan on each mesh, each search beginning at the plan before."""
    plans: list[Plan] = []
    for m in meshes:
        plans.append(plan(vehicle, road, m, settings=settings, start=plans[-1].nodes if plans else None))
    return plans
