"""Roads as CSV files: ours, and race tracks as they are published."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np

from fmus.planner.errors import PlanningError
from fmus.planner.path_road import PathRoad
from fmus.planner.road_columns import COLUMNS, PUBLISHED
from fmus.planner.road_rows import checked_rows


def read_road(path: Path, clearance: float = 0.84, closed: bool = False) -> PathRoad:
    """A road from a CSV file with the columns x, y, width_left, width_right [m]; PlanningError says what is wrong.

    Race tracks with the columns # x_m, y_m, w_tr_right_m, w_tr_left_m are read as they are. A closed road may repeat
    its first point at its end.
    """
    header, lines = _cells(path)
    table = np.array([_numbers(path, number, row) for number, row in enumerate(lines, 2) if row])
    table = table.reshape(-1, len(COLUMNS))[:, [header.index(name) for name in COLUMNS]]
    try:
        table = checked_rows(table, closed, f"the road {path}")
    except ValueError as error:
        raise PlanningError(str(error)) from None
    return PathRoad(table[:, :2], table[:, 2:], clearance, closed)


def _cells(path: Path) -> tuple[tuple[str, ...], list[list[str]]]:
    """The columns in the order of the file, and its lines after the first."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise PlanningError(f"the road {path} cannot be read ({error.strerror}); name a CSV file") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise PlanningError(f"the road {path} is not a text in UTF-8; name a CSV file") from error
    header = tuple(cell.strip().removeprefix("#").strip() for cell in rows[0]) if rows else ()
    if header == tuple(PUBLISHED):
        header = tuple(PUBLISHED.values())
    if header != COLUMNS and header != tuple(PUBLISHED.values()):
        raise PlanningError(
            f"the road {path} must begin with the line {','.join(COLUMNS)}, or as race tracks with # "
            f"{','.join(PUBLISHED)}"
        )
    return header, rows[1:]


def _numbers(path: Path, line: int, row: list[str]) -> list[float]:
    try:
        values = [float(cell) for cell in row]
    except ValueError:
        values = []
    if len(values) != len(COLUMNS) or not np.isfinite(values).all():
        raise PlanningError(f"line {line} of the road {path} must hold {len(COLUMNS)} finite numbers")
    return values
