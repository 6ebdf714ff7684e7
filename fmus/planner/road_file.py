"""Roads as CSV files: ours, and race tracks as they are published. The FMUs read them by the same reader."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from fmukit.runtime.description import TableFile
from fmukit.runtime.table import TableError, read
from fmus.planner.errors import PlanningError
from fmus.planner.path_road import PathRoad
from fmus.planner.road_columns import COLUMNS, PUBLISHED
from fmus.planner.road_rows import checked_rows

_MOST = 100_000
"""Rows of a file at most."""


def read_road(path: Path, clearance: float = 0.84, closed: bool = False) -> PathRoad:
    """A road from a CSV file with the columns x, y, width_left, width_right [m]; PlanningError says what is wrong.

    Race tracks with the columns # x_m, y_m, w_tr_right_m, w_tr_left_m are read as they are. A closed road may repeat
    its first point at its end.
    """
    table = TableFile(0, COLUMNS, _MOST, increasing=False, names=tuple(PUBLISHED.items()))
    try:
        flat, count = read(str(path), table, Path())
        rows = np.array(flat[: count * len(COLUMNS)]).reshape(count, len(COLUMNS))
        rows = checked_rows(rows, closed, f"the road {path}")
    except (TableError, ValueError) as error:
        raise PlanningError(str(error)) from None
    return PathRoad(rows[:, :2], rows[:, 2:], clearance, closed)
