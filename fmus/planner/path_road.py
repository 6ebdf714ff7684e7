"""A road along any centre line with widths to both sides, open or closed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline
from scipy.spatial import cKDTree

from fmus.planner.gates import Array, Gates, check_widths, checked

_DENSE = 20
WINDOW = 20.0
"""[m]: so near to a place that is known."""


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
        curve, s, _ = self.curve()
        check_widths(self.across())
        return checked(self._across(_even(curve, s, m)))

    def unrolled(self) -> PathRoad:
        """One lap of a closed road as an open one; an open road itself."""
        if not self.closed:
            return self
        points, widths = (np.vstack([rows, rows[:1]]) for rows in (self.points, self.widths))
        return PathRoad(points, widths, self.clearance)

    def across(self) -> Gates:
        """Gates at its own points, unchecked."""
        return self._across(self.curve()[1])

    def edges(self, count: int) -> tuple[Array, Array]:
        """`count` points (count, 2) of the left and of the right edge, less the clearance, for drawing: unchecked."""
        curve, s, _ = self.curve()
        gates = self._across(_even(curve, s, count - 1))
        return gates.point(gates.high), gates.point(gates.low)

    def _across(self, at: Array) -> Gates:
        """Gates at the distances `at` (n,) [m]."""
        curve, _, _ = self.curve()
        tangent = curve(at, 1)
        heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
        left, right = self.room(at).T
        return Gates(np.column_stack([curve(at), heading]), -right, left, self.closed)

    def room(self, at: Array) -> Array:
        """(n, 2) [m] from the spline at its places `at` (n,) to the left and to the right edge, less the clearance."""
        _, s, widths = self.curve()
        return np.column_stack([np.interp(at, s, widths[:, j]) - self.clearance for j in (0, 1)])

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which the points (n, 2) leave the road less its clearance; 0 inside."""
        return float(max(0.0, self.outside(points).max()))

    def outside(self, points: Array, near: Array | None = None) -> Array:
        """(n, 2) [m] by which the points (n, 2) are beyond the left and the right edge, less than 0 inside.

        They are taken across the nearest place on the spline; with `near` (n,), the nearest within WINDOW metres of
        these places, which matters where a road crosses itself.
        """
        curve, s, _ = self.curve()
        dense = np.linspace(s[0], s[-1], _DENSE * len(s))
        at = dense[_nearest(curve(dense), points, near, dense, self.closed)]
        tangent, away = curve(at, 1), points - curve(at)
        lateral = (tangent[:, 0] * away[:, 1] - tangent[:, 1] * away[:, 0]) / np.hypot(*tangent.T)
        left, right = self.room(at).T
        return np.column_stack([lateral - left, -right - lateral])

    def curve(self) -> tuple[CubicSpline, Array, Array]:
        """The spline, its parameters at the points (n,), about distances [m], and the widths (n, 2) there.

        On a closed road the last point is the first.
        """
        points, widths = self.points, self.widths
        if self.closed:
            points, widths = np.vstack([points, points[:1]]), np.vstack([widths, widths[:1]])
        s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
        return CubicSpline(s, points, bc_type="periodic" if self.closed else "not-a-knot"), s, widths


def _nearest(line: Array, points: Array, near: Array | None, at: Array, closed: bool) -> NDArray[np.int64]:
    """Rows (n,) of the `line` nearest to the points, near the places `near` of the places `at` of its rows if given."""
    if near is None:
        return np.asarray(cKDTree(line).query(points)[1])
    reach = max(1, round(WINDOW / (at[1] - at[0])))
    rows = np.searchsorted(at, near)[:, None] + np.arange(-reach, reach + 1)
    rows = rows % (len(at) - 1) if closed else np.clip(rows, 0, len(at) - 1)
    away = line[rows] - points[:, None, :]
    best = np.argmin(away[..., 0] ** 2 + away[..., 1] ** 2, axis=1)
    return np.asarray(rows[np.arange(len(rows)), best])


def _even(curve: CubicSpline, s: Array, m: int) -> Array:
    """m + 1 spline parameters at equal arc lengths."""
    dense = np.linspace(s[0], s[-1], _DENSE * max(m, len(s)))
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve(dense), axis=0).T))])
    return np.interp(np.linspace(0, length[-1], m + 1), length, dense)
