"""The road of arbitrary-path as its planner has it, also where it is set by hand, and the fastest motion along it."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from cosim.model.signals import Vector
from fmus.planner.errors import PlanningError
from fmus.planner.path_road import PathRoad
from fmus.planner.program import standing_ends
from fmus.planner.receding import built_in, offline, road, run
from fmus.planner.receding.interface import INTERFACE as PLANNER
from fmus.planner.receding.layout import HORIZON
from fmus.planner.road_rows import checked_rows, is_ring
from scenarios.shared.plans import planned, planned_along
from scenarios.shared.start import Point
from scenarios.shared.tables import read_columns

_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class LaidRoad:
    """The road of a run.

    `parameters` are what the planner starts with, by name, `gates` those it plans on, and `start` is where its plan
    begins. `path` is the road up to its edges, from which O1 keeps `half_width` [m] as long as the car is on the road.
    """

    parameters: Mapping[str, Any]
    gates: road.GatedRoad
    start: Point
    path: PathRoad
    half_width: float

    @property
    def drivable(self) -> PathRoad:
        """Where O1 may be, whatever the plan keeps from the edges."""
        return replace(self.path, clearance=self.half_width)

    def optimum(self) -> Path:
        """The time-optimal motion with car and limits of the planner, as a trajectory file from the cache.

        It starts anywhere across the road and ends at any speed, after one lap if the road is closed: on the gates of
        the planner on the built-in road, on a mesh that follows the road on others. Raises CosimError when there is
        none.
        """
        p = self.parameters
        ends = standing_ends(p["initial.speed"])
        ends.first[4] = p["initial.heading"]
        kept = replace(self.path, clearance=p["road.clearance"])
        if self.gates.horizon == HORIZON:
            return planned("arbitrary-path", offline.same_limits(p), kept, self.gates.last, ends)
        return planned_along("arbitrary-path", offline.same_limits(p), kept.unrolled(), ends)


def half_width(configuration: Configuration) -> float:
    """Distance [m] that O1 must keep from the edges of the road: what the planner keeps by its start value."""
    return float(configuration.start("planner", "road.clearance"))


def lay(configuration: Configuration) -> LaidRoad:
    """The road of the instance `planner`; raises CosimError saying what is wrong with its file or its values."""
    parameters = configuration.values("planner")
    table = _table(str(parameters["road_file"]))
    try:
        gates = road.read(parameters, table.tolist())
        x, y, speed, _, yaw, *_ = run.start(parameters, gates).x[0].tolist()
    except (ValueError, PlanningError) as error:
        raise CosimError(f"planner: {error}") from None
    closed = bool(parameters["road.closed"])
    rows = checked_rows(table, closed) if len(table) else built_in.rows()
    if not closed and is_ring(rows):
        _LOG.warning("the road ends where it begins, but is driven as open; for laps set planner.road.closed=true")
    path = PathRoad(rows[:, :2], rows[:, 2:], 0.0, closed)
    return LaidRoad(parameters, gates, Point(x, y, yaw, speed), path, half_width(configuration))


def _table(file: str) -> Vector:
    """x, y and widths to the left and to the right (n, 4) [m] of the road file; no rows without one."""
    return np.column_stack(list(read_columns(file, PLANNER).values())) if file else np.zeros((0, 4))
