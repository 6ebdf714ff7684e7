"""Plans by name, for the command line: a built-in road, or the file of a centre line."""

from __future__ import annotations

import difflib
import math
from collections.abc import Callable
from pathlib import Path

from fmus.cars import published
from fmus.controllers.reference.interface import ROWS
from fmus.planner import hocp
from fmus.planner.adaptive import planning
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Grid, Plan, PlanSettings
from fmus.planner.program import standing_ends
from fmus.planner.road import Corridor, double_lane_change
from fmus.planner.road_file import read_road
from fmus.planner.road_rows import is_ring
from fmus.planner.vehicle import Vehicle, two_wheel_drive

ROADS: dict[str, Callable[[], Corridor]] = {
    "double-lane-change": double_lane_change,
    "test-drive": lambda: double_lane_change(1.0, 0.75, 1.5, "cubic"),
}
"""The roads known by name; `test-drive` is the published one with its sharp edges."""
_USUAL = 80
"""Intervals of a plan on a road known by name."""
_LARGEST_VIOLATION, _LARGEST_ERROR = 0.2, 0.01
"""What is let pass without a remark [m] (engineering choices)."""
_LARGEST_RESIDUAL = 1e-5
"""The same, in scaled units: of size one, IPOPT asks for 1e-8 (engineering choice)."""
_CONVERGED = "Solve_Succeeded"


def named(
    name: str, m: int | None, grid: Grid, speed: float, vehicle: Vehicle | None = None, *, closed: bool = False
) -> Plan:
    """The plan from `speed` [m/s] on the road `name`, one of `ROADS` or a CSV file; `vehicle` or the default car.

    On m intervals, 80 if None; for a file on m or more, as the road needs. `closed`: the flying lap of a road that is
    joined to its start, from whatever speed is best.
    """
    if math.isnan(speed):
        raise PlanningError("give a speed at the start, in m/s")
    if m is not None and m >= ROWS:
        raise PlanningError(
            f"a plan on {m} intervals has more rows than ReferenceTrajectory takes; the most is {ROWS - 1}"
        )
    if m is not None and m < 2:
        raise PlanningError(f"a plan needs at least 2 intervals, not {m}")
    vehicle = vehicle or two_wheel_drive(published.single_track())
    if name in ROADS:
        if closed:
            raise PlanningError(f"{name} has two ends; only the CSV file of a road can be closed")
        return hocp.plan(vehicle, ROADS[name](), m or _USUAL, standing_ends(speed), PlanSettings(grid=grid))
    road = read_road(_file(name), closed=closed)
    if grid == "time":
        raise PlanningError("the time grid needs a road given as limits y(x); use the gate grid for a centre line")
    return planning.plan(vehicle, road, None if closed else standing_ends(speed), PlanSettings(), m or 0)


def road_remarks(name: str, *, closed: bool) -> list[str]:
    """What a user should know of a road that can be read."""
    if name in ROADS or closed or not is_ring(read_road(_file(name)).points):
        return []
    return [f"{name} ends where it begins; with --closed the flying lap is planned"]


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


def _file(name: str) -> Path:
    if Path(name).suffix == ".csv":
        return Path(name)
    close = difflib.get_close_matches(name, ROADS, n=1, cutoff=0.5)
    hint = f"did you mean {close[0]}?" if close else f"known are {', '.join(ROADS)}, or give the CSV file of a road"
    raise PlanningError(f"unknown road {name!r}; {hint}")
