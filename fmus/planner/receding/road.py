"""From the table of a road to gates at equal distances, and the part of them that lies ahead."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import PlanningError
from ..gates import Gates, checked
from ..road_rows import checked_rows
from . import built_in
from .centre_line import even, spline

Array = NDArray[np.float64]
MOST = 2000
"""Capacity: gates of one road."""
_HEAD, _COLUMNS = 4, 6
DERIVED = _HEAD + _COLUMNS * MOST


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
    closed = bool(p["road.closed"])
    rows = checked_rows(np.array(table or built_in.rows()), closed)
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
