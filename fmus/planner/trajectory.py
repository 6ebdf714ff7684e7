"""A plan as a trajectory file for ReferenceTrajectory."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fmus.controllers.reference.interface import COLUMNS, ROWS
from fmus.planner import check
from fmus.planner.files import write_table
from fmus.planner.gates import Array
from fmus.planner.hocp import Plan
from fmus.planner.vehicle import Vehicle


def table(plan: Plan, finer: int = check.FINER) -> Array:
    """(n, 7): time, x, y, course, speed, acceleration along the path, curvature; course = yaw + sideslip.

    `finer` rows per interval, or as many as ReferenceTrajectory has room for.
    """
    finer = max(1, min(finer, (ROWS - 1) // len(plan.nodes.T)))
    return rows(plan.vehicle, *check.fine(plan.vehicle, plan.nodes, plan.substeps, finer))


def rows(vehicle: Vehicle, times: Array, x: Array, u: Array) -> Array:
    """The same of states x (7, n) and inputs u (n_u, n) at `times` (n,) [s]."""
    rate = vehicle.f.map(len(times))(x, u).full()
    v = x[2]
    columns = times, x[0], x[1], x[3] + x[4], v, rate[2], (rate[3] + rate[4]) / v
    return np.column_stack(columns)


def write(plan: Plan, file: Path, finer: int = check.FINER) -> None:
    """Write the trajectory with its header line; raises PlanningError when the file cannot be written."""
    write_rows(table(plan, finer), file)


def write_rows(rows: Array, file: Path) -> None:
    """Write rows (n, 7) in the order of the columns with the header line; PlanningError as `write`."""
    write_table(COLUMNS, rows, file)
