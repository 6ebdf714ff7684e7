"""Whether a trajectory contradicts itself: course and speed against x and y over time."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.model.signals import Vector

_SPAN = 0.5
"""Time [s] over which motion is compared: longer than the noise of a log, shorter than a bend."""
_LEAST = 0.2
"""Way [m] in this time at least: a car that stands has no course."""
_LENGTH, _COURSE = 0.15, 0.25
"""Largest differences, of the way as a part of it and of the course [rad], in the median of all rows."""
_SAME = 0.05
"""So near are ways and courses that differ by their unit only [parts, rad]."""
_FEW = 3
"""Rows that contradict x and y at least."""


def check_trajectory(file: str, columns: Mapping[str, Vector]) -> None:
    """Raise CosimError naming the column that contradicts x and y over time, its unit if that explains it."""
    time = columns["time"]
    first = np.flatnonzero(time + _SPAN <= time[-1])
    last = np.searchsorted(time, time[first] + _SPAN)
    if not len(first):
        first, last = np.array([0]), np.array([len(time) - 1])
    x, y = (columns[axis][last] - columns[axis][first] for axis in "xy")
    way, driven = np.hypot(x, y), _integral(columns["speed"], time)
    moved = way > _LEAST
    if not moved.any():
        return
    _check_speed(file, way[moved], (driven[last] - driven[first])[moved])
    middle = 0.5 * (time[first] + time[last])[moved]
    _check_course(file, np.arctan2(y, x)[moved], _course(columns, middle), middle)


def _integral(values: Vector, time: Vector) -> Vector:
    return np.concatenate([[0.0], np.cumsum(0.5 * (values[1:] + values[:-1]) * np.diff(time))])


def _course(columns: Mapping[str, Vector], at: Vector) -> Vector:
    """The course of the nearest row: whatever its unit, it is not averaged."""
    time = columns["time"]
    after = np.clip(np.searchsorted(time, at), 1, len(time) - 1)
    nearer = after - (at - time[after - 1] < time[after] - at)
    return columns["course"][nearer]


def _check_speed(file: str, way: Vector, driven: Vector) -> None:
    ratio = float(np.median(driven / way))
    if abs(ratio - 1) <= _LENGTH:
        return
    says = f"trajectory {file}: by its speed the car drives {ratio:.3g} times as far as by x and y over time"
    if abs(ratio / 3.6 - 1) <= _SAME:
        raise CosimError(f"{says}; it seems to be in km/h, give m/s")
    raise CosimError(f"{says}; give time in s, x and y in m and speed in m/s")


def _check_course(file: str, direction: Vector, course: Vector, middle: Vector) -> None:
    """Few rows of a bend may betray a unit that the others, straight along the x axis, do not show."""
    off = _off(direction, course)
    wrong = off > _COURSE
    if wrong.sum() < _FEW:
        return
    in_degrees = _explains(direction, np.radians(course), wrong)
    clockwise = _explains(direction, np.pi / 2 - course, wrong)
    if not (in_degrees or clockwise) and np.median(off) <= _COURSE:
        return
    k = int(np.argmax(off))
    moving = f"at {middle[k]:g} s x and y move at {direction[k]:.2f} rad"
    says = f"trajectory {file}: {moving}, its course is {course[k]:.4g}"
    if in_degrees:
        raise CosimError(f"{says}; it seems to be in degrees, give radians")
    if clockwise:
        raise CosimError(f"{says}; it seems to count clockwise from the y axis, give it from x to the left")
    raise CosimError(f"{says}; give the direction of motion from the x axis to the left, in radians")


def _explains(direction: Vector, course: Vector, rows: NDArray[np.bool_]) -> bool:
    """Whether the course so read is right where it was wrong, and nearly always elsewhere."""
    off = _off(direction, course)
    return bool(np.median(off[rows]) <= _SAME and np.median(off) <= _SAME)


def _off(direction: Vector, course: Vector) -> Vector:
    """Differences [rad], whole turns apart."""
    return np.abs(_wrapped(direction - course))


def _wrapped(angle: Vector) -> Vector:
    return np.asarray(np.arctan2(np.sin(angle), np.cos(angle)))
