"""From the table of a road to gates at equal distances, and the part of them that lies ahead."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import PlanningError
from ..gates import Gates, checked
from . import built_in
from .centre_line import even, spline

Array = NDArray[np.float64]
MOST = 2000
"""Capacity: gates of one road."""
_HEAD, _COLUMNS = 4, 6
DERIVED = _HEAD + _COLUMNS * MOST
_AGAINST = -0.7
"""Cosine of a corner no road has twice in a row (engineering choice)."""


@dataclass(frozen=True, slots=True)
class GatedRoad:
    """`frames` (n, 3), `low`, `high` (n,) as in `Gates`; `curvature` (n,) [1/m] of the centre line, `spacing` [m].

    The last gate of a closed road is its first, one `turn` [rad] later.
    """

    frames: Array
    low: Array
    high: Array
    curvature: Array
    spacing: float
    closed: bool
    turn: float

    @property
    def last(self) -> int:
        """Number of the last gate."""
        return len(self.frames) - 1

    def gates(self, first: int, count: int) -> Gates:
        """`count` gates from number `first` on: round and round, or beyond the end straight on."""
        k = first + np.arange(count)
        if self.closed:
            laps, k = np.divmod(k, self.last)
            frames = self.frames[k] + np.outer(laps, [0.0, 0.0, self.turn])
        else:
            beyond, k = np.maximum(k - self.last, 0), np.minimum(k, self.last)
            heading = self.frames[-1, 2]
            frames = self.frames[k] + np.outer(beyond * self.spacing, [np.cos(heading), np.sin(heading), 0.0])
        return Gates(frames, self.low[k], self.high[k])

    def curvatures(self, first: int, count: int) -> Array:
        """(count,) [1/m]."""
        k = first + np.arange(count)
        return (
            self.curvature[k % self.last]
            if self.closed
            else np.where(k <= self.last, self.curvature[np.minimum(k, self.last)], 0.0)
        )


def read(p: Mapping[str, Any], table: Sequence[Sequence[float]]) -> GatedRoad:
    """The road of the table, or the built-in one without; raises ValueError naming what is wrong and where."""
    rows, closed = np.array(table or built_in.rows()), bool(p["road.closed"])
    _check(rows, closed)
    curve = spline(rows[:, :2], closed)
    at, spacing = even(curve, p["road.spacing"])
    if len(at) > MOST:
        raise ValueError(
            f"the road has {len(at)} gates {p['road.spacing']:g} m apart, but there is room for {MOST}; "
            "give a larger road.spacing or a shorter road"
        )
    tangent = curve.slope(at)
    heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    widths = np.vstack([rows[:, 2:], rows[:1, 2:]]) if closed else rows[:, 2:]
    left, right = (np.interp(at, curve.s, widths[:, j]) - p["road.clearance"] for j in (0, 1))
    frames = np.column_stack([curve(at), heading])
    try:
        checked(Gates(frames, -right, left))
    except PlanningError as error:
        raise ValueError(f"{error} (road.clearance, road.spacing)") from None
    return _road(frames, -right, left, spacing, closed)


def _road(frames: Array, low: Array, high: Array, spacing: float, closed: bool) -> GatedRoad:
    turn = frames[-1, 2] - frames[0, 2] if closed else 0.0
    heading = frames[:, 2]
    padded = (
        np.concatenate([[heading[-2] - turn], heading, [heading[1] + turn]])
        if closed
        else np.concatenate([heading[:1], heading, heading[-1:]])
    )
    curvature = (padded[2:] - padded[:-2]) / (2 * spacing)
    return GatedRoad(frames, low, high, curvature, spacing, closed, float(turn))


def _check(rows: Array, closed: bool) -> None:
    if len(rows) < 4:
        raise ValueError(f"the road has {len(rows)} points; give at least 4")
    if (rows[:, 2:] < 0).any():
        raise ValueError(f"the road has a negative width in row {1 + int(np.argmin(rows[:, 2:].min(axis=1)))}")
    around = np.vstack([rows, rows[:1]]) if closed else rows
    gaps = np.hypot(*np.diff(around[:, :2], axis=0).T)
    if not gaps.all():
        what = "it ends where it began; drop the last row" if closed and gaps[-1] == 0 else "drop one"
        raise ValueError(f"the road has the same point twice in a row, row {1 + int(np.argmin(gaps))}; {what}")
    if closed and _overshoots(rows[:, :2]):
        raise ValueError(
            f"the closed road goes past its start: row {len(rows)}, its last, lies {gaps[-1]:.1f} m beyond row 1, "
            "to which it is joined; drop the rows past the start"
        )


def _overshoots(points: Array) -> bool:
    """Whether the way from the last point back to the first goes against the road on both sides of it."""
    way = np.diff(np.vstack([points[-2:], points[:2]]), axis=0)
    before, back, after = way / np.hypot(*way.T)[:, None]
    return bool(max(before @ back, back @ after) < _AGAINST)


def to_numbers(road: GatedRoad) -> Array:
    """The road as DERIVED numbers."""
    d, n = np.zeros(DERIVED), len(road.frames)
    d[:_HEAD] = n, road.spacing, road.closed, road.turn
    columns = np.column_stack([road.frames, road.low, road.high, road.curvature])
    d[_HEAD : _HEAD + _COLUMNS * n] = columns.ravel()
    return d


def from_numbers(d: Sequence[float]) -> GatedRoad:
    """The road that was made these numbers."""
    numbers = np.asarray(d)
    n = int(numbers[0])
    columns = numbers[_HEAD : _HEAD + _COLUMNS * n].reshape(n, _COLUMNS)
    return GatedRoad(
        columns[:, :3],
        columns[:, 3],
        columns[:, 4],
        columns[:, 5],
        float(numbers[1]),
        bool(numbers[2]),
        float(numbers[3]),
    )
