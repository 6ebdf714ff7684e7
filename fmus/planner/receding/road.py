"""From the table of a road to gates along it, and the part of them that lies ahead."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import PlanningError
from ..gates import Gates, checked, uncrossed
from ..road_rows import checked_rows
from . import built_in
from .centre_line import spline
from .layout import HORIZON, LONG
from .stations import inset, stations

Array = NDArray[np.float64]
MOST = 2000
"""Capacity: gates of one road."""
_HEAD, _COLUMNS = 4, 7
DERIVED = _HEAD + _COLUMNS * MOST


@dataclass(frozen=True, slots=True)
class GatedRoad:
    """`frames` (n, 3), `low`, `high` (n,) as in `Gates`; `curvature` (n,) [1/m] of the centre line.

    They are `at` (n,) [m] along it. The last gate of a closed road is its first, one `turn` [rad] later. Local problems
    have `horizon` intervals.
    """

    frames: Array
    low: Array
    high: Array
    curvature: Array
    at: Array
    closed: bool
    turn: float
    horizon: int = HORIZON

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
            way = beyond * (self.at[-1] - self.at[-2])
            frames = self.frames[k] + np.outer(way, [np.cos(heading), np.sin(heading), 0.0])
        return Gates(frames, self.low[k], self.high[k])

    def distances(self, first: int, count: int) -> Array:
        """(count,) [m] along the road to `count` gates from number `first` on."""
        k = first + np.arange(count)
        if self.closed:
            laps, k = np.divmod(k, self.last)
            return self.at[k] + laps * self.at[-1]
        beyond = np.maximum(k - self.last, 0)
        return self.at[np.minimum(k, self.last)] + beyond * (self.at[-1] - self.at[-2])

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
    widths = np.vstack([rows[:, 2:], rows[:1, 2:]]) if closed else rows[:, 2:]
    room = widths - p["road.clearance"]
    at, distance = stations(curve, room if table else None, p, closed)
    if len(at) > MOST:
        raise ValueError(
            f"the road has {len(at)} gates {p['road.spacing']:g} m apart, but there is room for {MOST}; "
            "give a larger road.spacing or a shorter road"
        )
    tangent = curve.slope(at)
    heading = np.unwrap(np.arctan2(tangent[:, 1], tangent[:, 0]))
    turn = float(heading[-1] - heading[0]) if closed else 0.0
    length = np.diff(distance)
    curvature = _curvature(heading, distance, length.max(), turn, closed)
    left, right = (np.interp(at, curve.s, room[:, j]) for j in (0, 1))
    gates = Gates(np.column_stack([curve(at), heading]), -right, left, closed)
    try:
        gates = checked(uncrossed(gates))
    except PlanningError as error:
        raise ValueError(f"{error} (road.clearance, road.spacing)") from None
    if table:
        gates = inset(gates, _curvature(heading, distance, length.min(), turn, closed), distance)
    return GatedRoad(gates.frames, gates.low, gates.high, curvature, distance, closed, turn, LONG if table else HORIZON)


def _curvature(heading: Array, at: Array, reach: Array | float, turn: float, closed: bool) -> Array:
    """(n,) [1/m]: the turn over `reach` [m] to both sides of each gate, over this distance."""
    s = at
    if closed:
        s = np.concatenate([at[:-1] - at[-1], at, at[1:] + at[-1]])
        heading = np.concatenate([heading[:-1] - turn, heading, heading[1:] + turn])
    return np.asarray(np.interp(at + reach, s, heading) - np.interp(at - reach, s, heading)) / (2 * reach)


def to_numbers(road: GatedRoad) -> Array:
    """The road as DERIVED numbers."""
    d, n = np.zeros(DERIVED), len(road.frames)
    d[:_HEAD] = n, road.horizon, road.closed, road.turn
    columns = np.column_stack([road.frames, road.low, road.high, road.curvature, road.at])
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
        columns[:, 6],
        bool(numbers[2]),
        float(numbers[3]),
        int(numbers[1]),
    )
