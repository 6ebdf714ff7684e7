"""From a table of the trajectory to its value at any time."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from fmukit.kernel import Block, block
from fmus.cars.rotation import wrap
from fmus.clip import clip
from fmus.controllers.reference.interface import COLUMNS

_COUNT = len(COLUMNS)


def canonical(table: ca.MX, rows: ca.MX) -> ca.MX:
    """The (rows x 7) table of a file with a continuous course, its unused rows given increasing times.

    The course of the file may be wrapped: every increment is reduced to (-pi, pi].
    """
    time, course = table[:, 0], table[:, 3]
    unused = ca.DM(range(1, table.shape[0] + 1)) - rows
    steps = course[1:] - course[:-1]
    continuous = ca.vertcat(course[0], course[0] + ca.cumsum(wrap(steps)))
    times = ca.if_else(unused > 0, time[ca.fmax(rows - 1, 0)] + unused, time)
    return ca.horzcat(times, table[:, 1:3], continuous, table[:, 4:])


def lookup(times: int, rows: int) -> Block:
    """(table, ends, t) -> x, y, course, speed, acceleration, curvature (6 x times) at the times t [s].

    table  the rows as one column, column by column
    ends   first and last time [s] (2): before and after, course and speed are held, straight on
    """

    @block(symbol=ca.MX, table=rows * _COUNT, ends=2, t=times)
    def found(table: ca.MX, ends: ca.MX, t: ca.MX) -> ca.MX:
        inside = clip(t, ends[0], ends[1])
        index = ca.low(table[:rows], inside, {"lookup_mode": "binary"})
        left = [table[index + rows * column] for column in range(_COUNT)]
        right = [table[index + rows * column + 1] for column in range(_COUNT)]
        rows_of = [ca.horzcat(*columns).T for columns in (left, right)]
        return _between.function.map(times)(*rows_of, inside.T, (t - inside).T)

    return found


def played(table: NDArray[np.float64], t: float) -> NDArray[np.float64]:
    """x, y, course, speed, acceleration, curvature (6,) of a trajectory (n, 7) at t [s], as the FMU plays it."""
    n = len(table)
    rows, at = ca.MX.sym("table", n, _COUNT), ca.MX.sym("t")
    whole = canonical(rows, ca.MX(n))
    found = lookup(1, n)(ca.vec(whole), ca.vertcat(whole[0, 0], whole[n - 1, 0]), at)
    return np.asarray(ca.Function("played", [rows, at], [found])(table, t)).ravel()


@block(left=_COUNT, right=_COUNT, t=1, beyond=1)
def _between(left: ca.SX, right: ca.SX, t: ca.SX, beyond: ca.SX) -> ca.SX:
    """The six values of the trajectory between two rows; `beyond` is the time [s] outside the table.

    Position by quintic, course and speed by cubic Hermite polynomials; acceleration and curvature linearly.
    """
    h = right[0] - left[0]
    xi = (t - left[0]) / h
    position = _quintic(xi, h, _position(left), _position(right))
    course = _cubic(xi, h, (left[3], left[4] * left[6]), (right[3], right[4] * right[6]))
    speed = _cubic(xi, h, (left[4], left[5]), (right[4], right[5]))
    acceleration, curvature = (left[j] + xi * (right[j] - left[j]) for j in (5, 6))
    straight = ca.vertcat(ca.cos(course), ca.sin(course)) * speed * beyond
    known = beyond == 0
    return ca.vertcat(position + straight, course, speed, known * acceleration, known * curvature)


def _position(row: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Position, velocity and acceleration in world axes."""
    course, v, a, curvature = row[3], row[4], row[5], row[6]
    tangent = ca.vertcat(ca.cos(course), ca.sin(course))
    normal = ca.vertcat(-tangent[1], tangent[0])
    return row[1:3], v * tangent, a * tangent + v**2 * curvature * normal


def _quintic(xi: ca.SX, h: ca.SX, left: tuple[ca.SX, ca.SX, ca.SX], right: tuple[ca.SX, ca.SX, ca.SX]) -> ca.SX:
    """Hermite polynomial through value, first and second derivative at both ends of an interval of length h."""
    (p0, v0, a0), (p1, v1, a1) = left, right
    rise = xi**3 * (10 - 15 * xi + 6 * xi**2)
    velocity = h * (v0 * xi * (1 - xi**2 * (6 - 8 * xi + 3 * xi**2)) - v1 * xi**3 * (4 - 7 * xi + 3 * xi**2))
    curving = h**2 / 2 * (a0 * xi**2 * (1 - xi) ** 3 + a1 * xi**3 * (1 - xi) ** 2)
    return p0 + rise * (p1 - p0) + velocity + curving


def _cubic(xi: ca.SX, h: ca.SX, left: tuple[ca.SX, ca.SX], right: tuple[ca.SX, ca.SX]) -> ca.SX:
    """Hermite polynomial through value and derivative at both ends of an interval of length h."""
    (p0, v0), (p1, v1) = left, right
    rise = xi**2 * (3 - 2 * xi)
    return p0 + rise * (p1 - p0) + h * (v0 * xi * (1 - xi) ** 2 - v1 * xi**2 * (1 - xi))
