"""A road along any centre line with widths to both sides, open or closed."""

from __future__ import annotations

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array, Gates, check_widths, checked

COLUMNS = ("x", "y", "width_left", "width_right")
_DENSE = 20


@dataclass(frozen=True, slots=True)
class PathRoad:
    """Centre line `points` (n, 2) [m] and widths (n, 2) left and right of it [m]; a spline through the points.

    The centre of gravity keeps `clearance` [m] from both edges. A closed road does not repeat its first point.
    """

    points: Array
    widths: Array
    clearance: float = 0.84
    closed: bool = False

    def gates(self, m: int) -> Gates:
        """m + 1 gates at equal distances along the centre line; between them the road is checked at its own points."""
        curve, s, _ = self._curve()
        check_widths(self._across(s))
        return checked(self._across(_even(curve, s, m)))

    def edges(self, count: int) -> tuple[Array, Array]:
        """`count` points (count, 2) of the left and of the right edge, less the clearance, for drawing: unchecked."""
        curve, s, _ = self._curve()
        gates = self._across(_even(curve, s, count - 1))
        return gates.point(gates.high), gates.point(gates.low)

    def _across(self, at: Array) -> Gates:
        """Gates at the distances `at` (n,) [m]."""
        curve, s, widths = self._curve()
        tangent = curve(at, 1)
        heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
        left, right = (np.interp(at, s, widths[:, j]) - self.clearance for j in (0, 1))
        return Gates(np.column_stack([curve(at), heading]), -right, left, self.closed)

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which the points (n, 2) leave the road less its clearance; 0 inside."""
        curve, s, widths = self._curve()
        dense = np.linspace(s[0], s[-1], _DENSE * len(s))
        near = dense[cKDTree(curve(dense)).query(points)[1]]
        tangent, away = curve(near, 1), points - curve(near)
        lateral = (tangent[:, 0] * away[:, 1] - tangent[:, 1] * away[:, 0]) / np.hypot(*tangent.T)
        left, right = (np.interp(near, s, widths[:, j]) - self.clearance for j in (0, 1))
        return float(max(0.0, np.max(lateral - left), np.max(-right - lateral)))

    def _curve(self) -> tuple[CubicSpline, Array, Array]:
        points, widths = self.points, self.widths
        if self.closed:
            points, widths = np.vstack([points, points[:1]]), np.vstack([widths, widths[:1]])
        s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        return CubicSpline(s, points, bc_type="periodic" if self.closed else "not-a-knot"), s, widths


def read_road(path: Path, clearance: float = 0.84, closed: bool = False) -> PathRoad:
    """A road from a CSV file with the columns x, y, width_left, width_right [m]; PlanningError says what is wrong."""
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(file))
    except OSError as error:
        raise PlanningError(f"the road {path} cannot be read ({error.strerror}); name a CSV file") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise PlanningError(f"the road {path} is not a text in UTF-8; name a CSV file") from error
    header = tuple(cell.strip() for cell in rows[0]) if rows else ()
    if header != COLUMNS:
        raise PlanningError(f"the road {path} must begin with the line {','.join(COLUMNS)}")
    table = np.array([_numbers(path, number, row) for number, row in enumerate(rows[1:], 2) if row])
    _check(path, table, closed)
    return PathRoad(table[:, :2], table[:, 2:], clearance, closed)


def _numbers(path: Path, line: int, row: list[str]) -> list[float]:
    try:
        values = [float(cell) for cell in row]
    except ValueError:
        values = []
    if len(values) != len(COLUMNS) or not np.isfinite(values).all():
        raise PlanningError(f"line {line} of the road {path} must hold {len(COLUMNS)} finite numbers")
    return values


def _check(path: Path, table: Array, closed: bool) -> None:
    if len(table) < 4:
        raise PlanningError(f"the road {path} has {len(table)} points; give at least 4")
    if (table[:, 2:] < 0).any():
        raise PlanningError(
            f"the road {path} has a negative width in row {int(np.argmin(table[:, 2:].min(axis=1))) + 1}"
        )
    around = np.vstack([table, table[:1]]) if closed else table
    gaps = np.hypot(*np.diff(around[:, :2], axis=0).T)
    if (gaps == 0).any():
        raise PlanningError(
            f"the road {path} has the same point twice in a row, row {int(np.argmin(gaps)) + 1}; drop one"
        )


def _even(curve: CubicSpline, s: Array, m: int) -> Array:
    """m + 1 spline parameters at equal arc lengths."""
    dense = np.linspace(s[0], s[-1], _DENSE * max(m, len(s)))
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve(dense), axis=0).T))])
    return np.interp(np.linspace(0, length[-1], m + 1), length, dense)
