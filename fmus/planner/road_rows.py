"""The rows of a road file: x, y and the widths to the left and to the right [m]. Travels inside an FMU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_AGAINST = -0.7
"""Cosine of a corner no road has twice in a row (engineering choice)."""
_ONWARD, _NEAR = 0.5, 3.0
"""A road that ends where it began: cosine of the corners there at least, and the gap at most in usual distances."""
_APART = 1.5
"""So many usual distances from all early rows, the last one is not back at the start (engineering choice)."""
_SAME = 1e-6
"""Points nearer to each other than that [m] are one point."""


def checked_rows(rows: Array, closed: bool, name: str = "the road") -> Array:
    """The rows (n, 4), of a closed road without a last one at its first point; ValueError says what is wrong."""
    if closed and len(rows) > 4 and np.hypot(*(rows[0, :2] - rows[-1, :2])) < _SAME:
        rows = rows[:-1]
    if len(rows) < 4:
        raise ValueError(f"{name} has {len(rows)} points; give at least 4")
    if (rows[:, 2:] < 0).any():
        raise ValueError(f"{name} has a negative width in row {1 + int(np.argmin(rows[:, 2:].min(axis=1)))}")
    around = np.vstack([rows, rows[:1]]) if closed else rows
    gaps = np.hypot(*np.diff(around[:, :2], axis=0).T)
    if gaps.min() < _SAME:
        raise ValueError(f"{name} has the same point twice in a row, row {1 + int(np.argmin(gaps))}; drop one")
    if closed and min(_corners(rows[:, :2])) < _AGAINST:
        raise ValueError(_not_joined(name.removeprefix("the "), rows[:, :2], gaps))
    return rows


def _not_joined(name: str, points: Array, gaps: Array) -> str:
    """Why the last of the points (n, 2) cannot be joined to the first; the gaps (n,) [m] end with that way."""
    last = len(points)
    early = points[: last // 2]
    if np.hypot(*(early - points[-1]).T).min() > _APART * np.median(gaps):
        return (
            f"the closed {name} is no ring: row {last}, its last, lies {gaps[-1]:.1f} m from row 1, to which it is "
            f"joined; plan it as an open road, or give the rows that are missing"
        )
    return (
        f"the closed {name} goes past its start: row {last}, its last, lies "
        f"{gaps[-1]:.1f} m beyond row 1, to which it is joined; drop the rows past the start"
    )


def is_ring(rows: Array) -> bool:
    """Whether a road ends where it began, going on in the same direction, as the rows (n, 4) of race tracks do."""
    points = rows[:, :2]
    gap, usual = np.hypot(*(points[0] - points[-1])), np.median(np.hypot(*np.diff(points, axis=0).T))
    if gap == 0:
        points = points[:-1]
    return len(points) >= 8 and bool(gap <= _NEAR * usual) and min(_corners(points)) > _ONWARD


def _corners(points: Array) -> tuple[float, float]:
    """Cosines of the corners between the last part, the way from the last point to the first, and the first part."""
    way = np.diff(np.vstack([points[-2:], points[:2]]), axis=0)
    before, back, after = way / np.hypot(*way.T)[:, None]
    return float(before @ back), float(back @ after)
