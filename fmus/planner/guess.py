"""Where the search begins: down the middle of the gates, or along an earlier plan."""

from __future__ import annotations

import numpy as np

from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends, Nodes
from fmus.planner.vehicle import Vehicle

_GAIN, _BRAKE, _CORNER = 2.5, 4.0, 5.0
"""Accelerations [m/s2] of the guessed speed: gaining, braking, across (engineering choice)."""
_FASTEST = 40.0


def along_gates(vehicle: Vehicle, gates: Gates, ends: Ends) -> Nodes:
    """Mid-corridor at a speed that gains and brakes gently and slows down for turns of the road."""
    points = gates.point(0.5 * (gates.low + gates.high))
    change = np.diff(points, axis=0)
    length = np.hypot(*change.T)
    course = np.unwrap(np.arctan2(change[:, 1], change[:, 0]))
    course += gates.frames[0, 2] - course[0] - _wrapped(gates.frames[0, 2] - course[0])
    v = _speed(ends, length, gates)
    x = np.zeros((7, len(points)))
    x[:2], x[2], x[4, :-1], x[4, -1] = points.T, v, course, course[-1]
    T = 2 * length / (v[1:] + v[:-1])
    x[5, :-1] = np.diff(x[4]) / T
    return Nodes(x, np.repeat(vehicle.idle[:, None], len(T), axis=1), T)


def on_equal_times(nodes: Nodes) -> Nodes:
    """The same plan with nodes at equal times."""
    times, m = nodes.times, len(nodes.T)
    grid = np.linspace(0, times[-1], m + 1)
    x = np.array([np.interp(grid, times, row) for row in nodes.x])
    u = nodes.u[:, np.clip(np.searchsorted(times, grid[:-1], side="right") - 1, 0, m - 1)]
    return Nodes(x, u, np.full(m, times[-1] / m))


def refined(nodes: Nodes, m: int) -> Nodes:
    """The plan on m intervals, linear between its nodes, inputs held."""
    old = len(nodes.T)
    place = np.linspace(0, old, m + 1)
    x = np.array([np.interp(place, np.arange(old + 1), row) for row in nodes.x])
    u = nodes.u[:, np.minimum(place[:-1].astype(int), old - 1)]
    return Nodes(x, u, np.diff(np.interp(place, np.arange(old + 1), nodes.times)))


def _speed(ends: Ends, length: Array, gates: Gates) -> Array:
    curvature = np.abs(gates.steps[:, 2]) / length
    highest = np.append(np.sqrt(_CORNER / np.maximum(curvature, _CORNER / _FASTEST**2)), _FASTEST)
    v = highest.copy()
    if not np.isnan(ends.first[2]):
        v[0] = ends.first[2]
    for k, ds in enumerate(length):
        v[k + 1] = min(v[k + 1], np.sqrt(v[k] ** 2 + 2 * _GAIN * ds))
    for k in range(len(length) - 1, 0, -1):
        v[k] = min(v[k], np.sqrt(v[k + 1] ** 2 + 2 * _BRAKE * length[k]))
    return v


def _wrapped(angle: float) -> float:
    return float(np.arctan2(np.sin(angle), np.cos(angle)))
