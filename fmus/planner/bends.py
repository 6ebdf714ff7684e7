"""Whether a road has a bend that the car cannot turn, known before the search."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.optimize import root

from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array, Gates
from fmus.planner.vehicle import Vehicle

_SPEED, _SIDESLIP, _YAW_RATE, _STEER = 2, 3, 5, 6
_MARGIN = 0.95
"""Part of the car's smallest circle that a bend must leave: in transition a car turns a little tighter."""
_SPEEDS = (1.0, 1.5, 2.0, 3.0)
_WHEELBASES = (2.5, 3.5, 2.0)
"""Multiples of the lowest speed to turn at, and wheelbases [m] to begin the search for that turning with."""


def check_bends(vehicle: Vehicle, gates: Gates) -> None:
    """Raise PlanningError naming the tightest bend, if it leaves less room than the car's smallest circle."""
    own = smallest_circle(vehicle)
    radius, k = tightest_bend(gates, _MARGIN * own)
    if radius < _MARGIN * own:
        x, y = gates.frames[k, :2]
        raise PlanningError(
            f"the bend near x = {x:.1f} m, y = {y:.1f} m leaves room for a turn of {radius:.1f} m radius at most and "
            f"the smallest of this car is {own:.1f} m; widen the road there or make it less sharp"
        )


def smallest_circle(vehicle: Vehicle) -> float:
    """Radius [m] of the tightest steady turning at full steering angle, at low speeds; 0 if none is found."""
    radii = [_turning(vehicle, factor * vehicle.lower[_SPEED]) for factor in _SPEEDS]
    return min((radius for radius in radii if radius is not None), default=0.0)


def _turning(vehicle: Vehicle, v: float) -> float | None:
    """Radius [m] of steady turning at v [m/s] without drive and brakes; None if the search does not find it."""
    x, rolling = np.zeros(len(vehicle.scale)), np.clip(0.0, vehicle.input_lower, vehicle.input_upper)
    x[_SPEED], x[_STEER] = v, vehicle.upper[_STEER]

    def change(turning: Array) -> Array:
        x[[_SIDESLIP, _YAW_RATE]] = turning
        return vehicle.f(x, rolling).full().ravel()[[_SIDESLIP, _YAW_RATE]]

    for wheelbase in _WHEELBASES:
        found = root(change, [0.5 * x[_STEER], v * np.tan(x[_STEER]) / wheelbase])
        if found.success and found.x[1] > 0:
            return float(v / found.x[1])
    return None


def tightest_bend(gates: Gates, below: float) -> tuple[float, int]:
    """(radius [m], gate) of the bend with the least room, if it is less than `below`; else (infinity, 0).

    A bend of radius r or less over the angle theta, between edges at r_i and r_o from its centre, has room for an arc
    from the outer edge by the inner edge to the outer edge again, of radius (r_o - r_i c) / (1 - c), c = cos(theta/2),
    and no larger one; for a half turn and more it is r_o.
    """
    found = min(_bends(gates, below), default=(np.inf, 0))
    return found if found[0] < below else (np.inf, 0)


def _bends(gates: Gates, below: float) -> Iterator[tuple[float, int]]:
    """Room and middle gate of every run of gates that turn one way at least as sharply as 1/r, for every such r."""
    length = np.hypot(*gates.steps[:, :2].T)
    for side, inner, outer in ((1, gates.high, -gates.low), (-1, -gates.low, gates.high)):
        turn = side * gates.steps[:, 2]
        curvature = turn / length
        least = 1 / max(below - outer.min(), 1e-3)  # no bend less sharp has less room
        for sharp in np.unique(curvature[curvature > least]):
            for first, last in _runs(curvature >= sharp):
                part = slice(first, last + 1)
                c = np.cos(min(0.5 * float(turn[first:last].sum()), np.pi / 2))
                r_i, r_o = max(1 / sharp - inner[part].max(), 0.0), 1 / sharp + outer[part].max()
                yield float((r_o - r_i * c) / (1 - c)), (first + last) // 2


def _runs(mask: Array) -> list[tuple[int, int]]:
    """(first, last + 1) of every stretch of true values."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))
