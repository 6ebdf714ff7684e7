"""A plan as a trajectory file for ReferenceTrajectory."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fmus.controllers.reference.interface import COLUMNS
from fmus.planner import check
from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array
from fmus.planner.hocp import Plan


def table(plan: Plan, finer: int = check.FINER) -> Array:
    """(n, 7): time, x, y, course, speed, acceleration along the path, curvature; course = yaw + sideslip."""
    times, x, u = check.fine(plan.vehicle, plan.nodes, plan.substeps, finer)
    rate = plan.vehicle.f.map(len(times))(x, u).full()
    v = x[2]
    columns = times, x[0], x[1], x[3] + x[4], v, rate[2], (rate[3] + rate[4]) / v
    return np.column_stack(columns)


def write(plan: Plan, file: Path, finer: int = check.FINER) -> None:
    """Write the trajectory with its header line; raises PlanningError when the file cannot be written."""
    rows = [",".join(COLUMNS), *(",".join(f"{value:.9g}" for value in row) for row in table(plan, finer))]
    try:
        file.write_text("\n".join(rows) + "\n", "utf-8")
    except OSError as error:
        raise PlanningError(f"{file} cannot be written ({error.strerror}); name another file") from error
