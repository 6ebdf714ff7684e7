"""Plans by name, for the command line: a built-in road, or the file of a centre line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from pathlib import Path

from fmus.cars import published
from fmus.controllers.reference.interface import ROWS
from fmus.planner import hocp
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Grid, Plan, PlanSettings
from fmus.planner.path_road import read_road
from fmus.planner.program import standing_ends
from fmus.planner.road import Corridor, double_lane_change
from fmus.planner.vehicle import Vehicle, two_wheel_drive

ROADS: dict[str, Callable[[], Corridor]] = {
    "double-lane-change": double_lane_change,
    "test-drive": lambda: double_lane_change(1.0, 0.75, 1.5, "cubic"),
}
"""The roads known by name; `test-drive` is the published one with its sharp edges."""
_LARGEST_VIOLATION, _LARGEST_ERROR = 0.2, 0.01
"""What is let pass without a remark [m] (engineering choices)."""
_LARGEST_RESIDUAL = 1e-5
"""The same, in scaled units: of size one, IPOPT asks for 1e-8 (engineering choice)."""
_CONVERGED = "Solve_Succeeded"


def named(name: str, m: int, grid: Grid, speed: float, vehicle: Vehicle | None = None) -> Plan:
    """The plan from `speed` [m/s] on the road `name`, one of `ROADS` or a CSV file; `vehicle` or the default car."""
    if math.isnan(speed):
        raise PlanningError("give a speed at the start, in m/s")
    if m >= ROWS:
        raise PlanningError(
            f"a plan on {m} intervals has more rows than ReferenceTrajectory takes; the most is {ROWS - 1}"
        )
    vehicle = vehicle or two_wheel_drive(published.single_track())
    return hocp.plan(vehicle, _road(name), m, standing_ends(speed), PlanSettings(grid=grid))


def remarks(violation: float, replay_error: float, residual: float, status: str) -> list[str]:
    """What a user should know of a search that stopped early or a mesh too coarse; distances in m, see `Plan`."""
    found = []
    if status != _CONVERGED:
        found.append(f"IPOPT ended with {status}: the plan may not be the fastest; try other intervals")
    if residual > _LARGEST_RESIDUAL:
        found.append(f"at its nodes the plan breaks its constraints by {residual:.2g} (scaled); try other intervals")
    if violation > _LARGEST_VIOLATION:
        found.append(f"between its nodes the plan leaves the road by {violation:.2f} m; take more intervals")
    if replay_error > _LARGEST_ERROR:
        found.append(f"within an interval the plan is wrong by {replay_error:.2g} m; take more intervals")
    return found


def _road(name: str) -> hocp.Road:
    if name in ROADS:
        return ROADS[name]()
    if Path(name).suffix == ".csv":
        return read_road(Path(name))
    close = difflib.get_close_matches(name, ROADS, n=1, cutoff=0.5)
    hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(ROADS)}, or give the CSV file of a road"
    raise PlanningError(f"unknown road {name!r}; {hint}")
