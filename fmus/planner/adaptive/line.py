"""A smooth line along a road, which measured centre lines are not, with the same edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.interpolate import CubicSpline
from scipy.ndimage import maximum_filter1d
from scipy.sparse.linalg import splu

from fmus.planner.gates import Array, Gates, uncrossed
from fmus.planner.path_road import PathRoad

_LENGTH = 4.0
"""lambda [m]: bends of the centre line shorter than this are noise."""
_STEP = 1.0
"""Distance [m] of the points of the line."""
_LEAST = 100
"""Points of a line at least."""
_SHIFT, _TRIES = 0.3, 20
"""Largest shift of the line as part of the width to that side, and how often it is drawn back."""
_HELD = 1e6
"""How much more the ends of an open line are held than its other points."""
_WINDOW = 25
"""Points of an edge to either side, among which its crossing with a normal is searched: elsewhere the road may cross
itself."""

_STRAY = 1.0
"""By so much [m], beside its usual distance, an edge may be further away than usual."""


@dataclass(frozen=True, slots=True)
class Line:
    """n points at the distances `s` (n,) [m] along it; on a closed one the last is the first.

    `points` (n, 2) and continuous `heading` (n,) are those of the spline `curve`; `left`, `right` (n,) [m] are the
    distances to the edges less the clearance, `curvature` (n,) [1/m], and `beneath` (n,) the places on the spline of
    the road.
    """

    s: Array
    curve: CubicSpline
    points: Array
    heading: Array
    curvature: Array
    left: Array
    right: Array
    beneath: Array
    closed: bool

    @property
    def length(self) -> float:
        """[m]."""
        return float(self.s[-1])

    def gates(self, at: Array) -> Gates:
        """Gates at the distances `at` (k,) [m]; where their insides would cross they are shortened."""
        slope = self.curve(at, 1)
        heading = np.interp(at, self.s, self.heading)
        heading += _wrapped(np.arctan2(slope[:, 1], slope[:, 0]) - heading)
        left, right = (np.interp(at, self.s, width) for width in (self.left, self.right))
        return uncrossed(Gates(np.column_stack([self.curve(at), heading]), -right, left, self.closed))

    def edges(self) -> tuple[Array, Array]:
        """Points (n, 2) of the left and the right edge, less the clearance."""
        normal = np.column_stack([-np.sin(self.heading), np.cos(self.heading)])
        return self.points + normal * self.left[:, None], self.points - normal * self.right[:, None]


def smooth_line(road: PathRoad) -> Line:
    """The line p nearest to the centre line c in the sense of min |p - c|^2 + lambda^4 |p''|^2, with the road's edges.

    An open line keeps its ends and its directions there.
    """
    beneath, centre, normal, widths = _sampled(road)
    points = _smoothed(centre, normal, widths, road.closed)
    across = np.sum((points - centre) * normal, axis=1)
    s = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    curve = CubicSpline(s, points, bc_type="periodic" if road.closed else "not-a-knot")
    slope, bend = curve(s, 1), curve(s, 2)
    heading = np.unwrap(np.arctan2(slope[:, 1], slope[:, 0]))
    curvature = (slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0]) / np.hypot(*slope.T) ** 3
    new = np.column_stack([-np.sin(heading), np.cos(heading)])
    usual = widths - np.column_stack([across, -across])
    left = _reached(points, new, centre + normal * widths[:, :1], usual[:, 0], road.closed)
    right = _reached(points, -new, centre - normal * widths[:, 1:], usual[:, 1], road.closed)
    return Line(s, curve, points, heading, curvature, left, right, beneath, road.closed)


def _sampled(road: PathRoad) -> tuple[Array, Array, Array, Array]:
    """Places on the road's spline at equal distances, points there, normals, and widths less the clearance."""
    curve, s, _ = road.curve()
    fine = np.linspace(s[0], s[-1], 20 * len(s))
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve(fine), axis=0).T))])
    count = max(round(length[-1] / _STEP), _LEAST)
    beneath = np.interp(np.linspace(0.0, length[-1], count + 1), length, fine)
    slope = curve(beneath, 1)
    normal = np.column_stack([-slope[:, 1], slope[:, 0]]) / np.hypot(*slope.T)[:, None]
    return beneath, curve(beneath), normal, road.room(beneath)


def _smoothed(centre: Array, normal: Array, widths: Array, closed: bool) -> Array:
    """The line (n, 2), held the closer to the centre line the more it would leave the part _SHIFT of the widths."""
    near = np.ones(len(centre) - closed)
    if not closed:
        near[[0, 1, -2, -1]] = _HELD
    points = centre
    for _ in range(_TRIES):
        points = _nearest_smooth(centre[: len(near)], near, closed)
        points = np.vstack([points, points[:1]]) if closed else points
        across = np.sum((points - centre) * normal, axis=1)
        share = np.maximum(across / widths[:, 0], -across / widths[:, 1])[: len(near)] / _SHIFT
        if share.max() <= 1:
            break
        far = maximum_filter1d(share, 5, mode="wrap" if closed else "nearest")
        near = near * np.clip(far, 1.0, None) ** 2
    return points


def _nearest_smooth(points: Array, near: Array, closed: bool) -> Array:
    """The points p with the least sum near |p - c|^2 + lambda^4 |p''|^2."""
    n, step = len(points), float(np.hypot(*np.diff(points, axis=0).T).mean())
    rows = np.arange(n) if closed else np.arange(1, n - 1)
    columns = np.concatenate([(rows + j) % n for j in (-1, 0, 1)])
    values = np.repeat([1.0, -2.0, 1.0], len(rows))
    second = sparse.csc_matrix((values, (np.tile(np.arange(len(rows)), 3), columns)), shape=(len(rows), n))
    matrix = sparse.diags(near) + (_LENGTH / step) ** 4 * (second.T @ second)
    return np.asarray(splu(sparse.csc_matrix(matrix)).solve(near[:, None] * points))


def _reached(points: Array, direction: Array, edge: Array, usual: Array, closed: bool) -> Array:
    """How far (n,) it is along each direction to the edge near by, the `usual` way where the two do not meet.

    An edge that is much further than usual, or behind, belongs to another part of the road.
    """
    n = len(points) - closed
    j = np.arange(len(points))[:, None] + np.arange(-_WINDOW, _WINDOW)
    j, ahead = (j % n, (j + 1) % n) if closed else (np.clip(j, 0, n - 1), np.clip(j + 1, 0, n - 1))
    start = edge[j] - points[:, None, :]
    along = edge[ahead] - edge[j]
    d = direction[:, None, :]
    with np.errstate(divide="ignore", invalid="ignore"):
        cross = along[..., 0] * d[..., 1] - along[..., 1] * d[..., 0]
        part = (d[..., 0] * start[..., 1] - d[..., 1] * start[..., 0]) / cross
        way = (along[..., 0] * start[..., 1] - along[..., 1] * start[..., 0]) / cross
    own = (way > 0) & (np.abs(way - usual[:, None]) <= np.abs(usual)[:, None] + _STRAY)
    meets = (part >= 0) & (part <= 1) & (cross != 0) & own
    near = np.where(meets, np.abs(way - usual[:, None]), np.inf)
    best = np.argmin(near, axis=1)
    k = np.arange(len(points))
    found: Array = np.where(np.isfinite(near[k, best]), way[k, best], usual)
    return found


def _wrapped(angle: Array) -> Array:
    return np.arctan2(np.sin(angle), np.cos(angle))
