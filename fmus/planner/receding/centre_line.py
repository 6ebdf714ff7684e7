"""A centre line through points: the cubic spline through them, and points at equal distances along it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
_DENSE = 20


@dataclass(frozen=True, slots=True)
class Spline:
    """Through `points` (n, 2) at the parameters `s` (n,) with the slopes `m` (n, 2); twice continuously differentiable.

    A closed one repeats its first point as its last.
    """

    s: Array
    points: Array
    m: Array

    def __call__(self, at: Array) -> Array:
        """(k, 2) points."""
        xi, h, (p0, p1), (m0, m1) = self._around(at)
        change = p1 - p0
        return p0 + xi * (h * m0 + xi * (3 * change - h * (2 * m0 + m1) + xi * (h * (m0 + m1) - 2 * change)))

    def slope(self, at: Array) -> Array:
        """(k, 2) derivatives with respect to the parameter."""
        xi, h, (p0, p1), (m0, m1) = self._around(at)
        change = p1 - p0
        return m0 + xi * (2 * (3 * change / h - 2 * m0 - m1) + 3 * xi * (m0 + m1 - 2 * change / h))

    def _around(self, at: Array) -> tuple[Array, Array, tuple[Array, Array], tuple[Array, Array]]:
        j = np.clip(np.searchsorted(self.s, at, side="right") - 1, 0, len(self.s) - 2)
        h = self.s[j + 1] - self.s[j]
        ends = (self.points[j], self.points[j + 1]), (self.m[j], self.m[j + 1])
        return ((at - self.s[j]) / h)[:, None], h[:, None], *ends


def spline(points: Array, closed: bool) -> Spline:
    """The spline through `points` (n, 2), n >= 4, over the distance from point to point; not-a-knot or periodic."""
    if closed:
        points = np.vstack([points, points[:1]])
    h = np.hypot(*np.diff(points, axis=0).T)
    d = np.diff(points, axis=0) / h[:, None]
    s = np.concatenate([[0.0], np.cumsum(h)])
    return Spline(s, points, _periodic(h, d) if closed else _not_a_knot(h, d))


def _not_a_knot(h: Array, d: Array) -> Array:
    """Slopes (n, 2) from the lengths h (n-1,) and the slopes d (n-1, 2) of the chords."""
    n = len(h) + 1
    first, last = h[0] + h[1], h[-1] + h[-2]
    inner = np.arange(1, n - 1)
    rows = np.concatenate([[0, 0], np.repeat(inner, 3), [n - 1, n - 1]])
    columns = np.concatenate([[0, 1], (inner[:, None] + [-1, 0, 1]).ravel(), [n - 2, n - 1]])
    band = np.column_stack([h[1:], 2 * (h[1:] + h[:-1]), h[:-1]]).ravel()
    values = np.concatenate([[h[1], first], band, [last, h[-2]]])
    right = np.vstack(
        [
            ((h[0] + 2 * first) * h[1] * d[0] + h[0] ** 2 * d[1]) / first,
            3 * (h[1:, None] * d[:-1] + h[:-1, None] * d[1:]),
            (h[-1] ** 2 * d[-2] + (2 * last + h[-1]) * h[-2] * d[-1]) / last,
        ]
    )
    return _solved(rows, columns, values, right)


def _periodic(h: Array, d: Array) -> Array:
    n = len(h)
    k = np.arange(n)
    before, chord = np.roll(h, 1), np.roll(d, 1, axis=0)
    rows, columns = np.repeat(k, 3), ((k[:, None] + [-1, 0, 1]) % n).ravel()
    values = np.column_stack([h, 2 * (h + before), before]).ravel()
    m = _solved(rows, columns, values, 3 * (h[:, None] * chord + before[:, None] * d))
    return np.vstack([m, m[:1]])


def _solved(rows: NDArray[Any], columns: NDArray[Any], values: Array, right: Array) -> Array:
    n = len(right)
    matrix = ca.DM.triplet(rows.tolist(), columns.tolist(), ca.DM(values), n, n)
    return np.asarray(ca.solve(matrix, ca.DM(right), "csparse").full())


def even(curve: Spline, spacing: float) -> tuple[Array, Array]:
    """Parameters at equal arc lengths, as close to `spacing` [m] as a whole number of intervals (2 at least) allows.

    And these distances [m] along the curve.
    """
    dense, length = measured(curve, spacing)
    count = max(2, round(length[-1] / spacing))
    at = np.linspace(0, length[-1], count + 1)
    return np.interp(at, length, dense), at


def measured(curve: Spline, spacing: float) -> tuple[Array, Array]:
    """Parameters close together, and the arc lengths [m] there."""
    s = curve.s
    dense = np.linspace(s[0], s[-1], _DENSE * max(round(s[-1] / spacing), len(s)))
    return dense, np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve(dense), axis=0).T))])
