"""The table of last points over friction, lateral offset and speed: computed, kept as CSV, interpolated."""

from __future__ import annotations

import csv
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np

from fmus.planner.errors import PlanningError
from fmus.planner.evasion.braking import stopping_distance, stopping_distance_of_car
from fmus.planner.evasion.last_point import Search, Task, search
from fmus.planner.evasion.situation import Surroundings
from fmus.planner.files import write_table
from fmus.planner.gates import Array

FRICTIONS = (0.3, 0.6, 1.0)
OFFSETS = (1.5, 2.5, 3.5)
SPEEDS = (15.0, 20.0, 25.0, 30.0, 35.0)
COLUMNS = ("friction", "offset", "speed", "brake", "brake_of_car", "steer", "brake_and_steer")
FILE = Path(__file__).with_name("last_points.csv")
"""The table of the default car and road, as `fmus plan collision-avoidance -o` writes it."""


@dataclass(frozen=True, slots=True)
class LastPointTable:
    """Rows (n, 7) of `COLUMNS` in SI units, in the order of the grid: friction, offset, speed."""

    rows: Array
    frictions: Array
    offsets: Array
    speeds: Array

    def at(self, column: str, friction: float, offset: float, speed: float) -> float:
        """The value [m], linear between the points of the grid, in friction over 1/sqrt(mu); checks the ranges.

        The way of a car at its grip is in proportion to 1/sqrt(mu) where steering takes no time.
        """
        axes = (self.frictions, self.offsets, self.speeds)
        place = (friction, offset, speed)
        for name, unit, value, axis in zip(
            ("friction", "lateral offset", "speed"), ("", " m", " m/s"), place, axes, strict=True
        ):
            if not axis[0] - 1e-9 <= value <= axis[-1] + 1e-9:
                raise PlanningError(
                    f"the {name} is {value:g}{unit}; the table of last points holds {axis[0]:g} to {axis[-1]:g}{unit}"
                )
        values = self.rows[:, COLUMNS.index(column)].reshape([len(axis) for axis in axes])
        grid = (-1 / np.sqrt(self.frictions), self.offsets, self.speeds)
        return _linear(values, grid, (-1 / np.sqrt(friction), offset, speed))


def compute(
    surroundings: Surroundings | None = None,
    *,
    frictions: tuple[float, ...] = FRICTIONS,
    offsets: tuple[float, ...] = OFFSETS,
    speeds: tuple[float, ...] = SPEEDS,
    using: Search | None = None,
    progress: Callable[[int, int], None] = lambda _done, _total: None,
) -> LastPointTable:
    """The table of a road, solved point by point; `progress` (done, total) is told after each."""
    s, using = surroundings or Surroundings(), using or search(edge=True)
    places = [(mu, offset, v) for mu in frictions for offset in offsets for v in speeds]
    rows = []
    for done, (mu, offset, v) in enumerate(places, start=1):
        steer = using.solve(Task(v, mu, offset, "steer", s.edge)).distance
        both = using.solve(Task(v, mu, offset, "brake", s.edge)).distance
        brake = stopping_distance(v, mu, s.deceleration)
        rows.append((mu, offset, v, brake, stopping_distance_of_car(v, mu), steer, min(both, steer)))
        progress(done, len(places))
    return _table(np.array(rows))


def write(table: LastPointTable, file: Path) -> None:
    """Write the table as CSV with six digits; raises PlanningError when the file cannot be written."""
    write_table(COLUMNS, np.array([[float(f"{value:.6g}") for value in row] for row in table.rows]), file)


@cache
def read(file: Path = FILE) -> LastPointTable:
    """The table of a CSV file; raises PlanningError when it is none."""
    try:
        with file.open(newline="", encoding="utf-8") as source:
            header, *rows = list(csv.reader(source))
        table = _table(np.array([[float(cell) for cell in row] for row in rows]))
    except (OSError, ValueError, IndexError) as error:
        raise PlanningError(f"{file} is no table of last points ({error}); compute it anew") from error
    if tuple(header) != COLUMNS:
        raise PlanningError(f"{file} must begin with the line {','.join(COLUMNS)}")
    return table


def _table(rows: Array) -> LastPointTable:
    frictions, offsets, speeds = (np.unique(rows[:, k]) for k in range(3))
    if not (len(rows) == len(frictions) * len(offsets) * len(speeds) and np.isfinite(rows).all()):
        raise ValueError("its rows are not a grid of friction, offset and speed")
    return LastPointTable(rows[np.lexsort(rows[:, 2::-1].T)], frictions, offsets, speeds)


def _linear(values: Array, axes: tuple[Array, ...], place: tuple[float, ...]) -> float:
    """Multilinear interpolation, the last axis first."""
    for axis, at in zip(reversed(axes), reversed(place), strict=True):
        k = int(np.clip(np.searchsorted(axis, at) - 1, 0, len(axis) - 2)) if len(axis) > 1 else 0
        if len(axis) == 1:
            values = values[..., 0]
            continue
        part = (at - axis[k]) / (axis[k + 1] - axis[k])
        values = (1 - part) * values[..., k] + part * values[..., k + 1]
    return float(values)
