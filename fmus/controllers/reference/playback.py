"""From a table of the trajectory to its value at any time."""

from __future__ import annotations

import casadi as ca

from fmus.controllers.reference.interface import COLUMNS

_COUNT = len(COLUMNS)


def canonical(table: ca.MX, rows: ca.MX) -> ca.MX:
    """The (rows x 7) table of a file with a continuous course, its unused rows given increasing times.

    The course of the file may be wrapped: every increment is reduced to (-pi, pi].
    """
    time, course = table[:, 0], table[:, 3]
    unused = ca.DM(range(1, table.shape[0] + 1)) - rows
    steps = course[1:] - course[:-1]
    wrapped = ca.atan2(ca.sin(steps), ca.cos(steps))
    continuous = ca.vertcat(course[0], course[0] + ca.cumsum(wrapped))
    times = ca.if_else(unused > 0, time[ca.fmax(rows - 1, 0)] + unused, time)
    return ca.horzcat(times, table[:, 1:3], continuous, table[:, 4:])


def lookup(times: int, rows: int) -> ca.Function:
    """(table as a column, first and last time, times) -> (6 x times) x, y, course, speed, acceleration, curvature.

    Before the first and after the last row the course and the speed are held: straight on.
    """
    table, ends, t = ca.MX.sym("table", rows * _COUNT), ca.MX.sym("ends", 2), ca.MX.sym("t", times)
    inside = ca.fmin(ca.fmax(t, ends[0]), ends[1])
    index = ca.low(table[:rows], inside, {"lookup_mode": "binary"})
    left = [table[index + rows * column] for column in range(_COUNT)]
    right = [table[index + rows * column + 1] for column in range(_COUNT)]
    rows_of = [ca.horzcat(*columns).T for columns in (left, right)]
    values = _between().map(times)(*rows_of, inside.T, (t - inside).T)
    return ca.Function("lookup", [table, ends, t], [values])


def _between() -> ca.Function:
    """(row, next row, time between them, time outside the table) -> the six values of the trajectory.

    Position by quintic, course and speed by cubic Hermite polynomials; acceleration and curvature linearly.
    """
    left, right, t, beyond = ca.SX.sym("left", _COUNT), ca.SX.sym("right", _COUNT), ca.SX.sym("t"), ca.SX.sym("beyond")
    h = right[0] - left[0]
    xi = (t - left[0]) / h
    position = _quintic(xi, h, _position(left), _position(right))
    course = _cubic(xi, h, (left[3], left[4] * left[6]), (right[3], right[4] * right[6]))
    speed = _cubic(xi, h, (left[4], left[5]), (right[4], right[5]))
    acceleration, curvature = (left[j] + xi * (right[j] - left[j]) for j in (5, 6))
    straight = ca.vertcat(ca.cos(course), ca.sin(course)) * speed * beyond
    known = beyond == 0
    values = ca.vertcat(position + straight, course, speed, known * acceleration, known * curvature)
    return ca.Function("between", [left, right, t, beyond], [values])


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
