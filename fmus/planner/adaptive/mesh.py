"""Where the gates of a plan stand: closer where the car is slow and where the edges bend."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import maximum_filter1d

from fmus.planner.adaptive.line import Line
from fmus.planner.gates import Array, Gates, gradual

FARTHEST, NEAREST = 12.0, 1.0
"""Largest and smallest distance of two gates [m]."""
_BOW = 0.04
"""Bow [m] of an edge over the chord between two gates that is aimed at."""
_ROUGH = 3.0
"""Distance [m] down to which edges that bend, or seem to because they are measured, draw gates together."""
_STABLE = 60.0
"""Substeps v^2 [m2/s2] per metre between gates: the yaw motion dies out with about 120/v per second, and the
Runge-Kutta method is stable up to 2.8 of that per substep."""
_SHARED = 50
"""Numbers of intervals are multiples of this, so that compiled code serves many roads."""
_PATH, _SHARPEST = 0.6, 0.1
"""The path is taken to bend this part as much as the line, and at most so much [1/m]."""
_MOST_INSET = 0.3
"""[m]."""


@dataclass(frozen=True, slots=True)
class Mesh:
    """The gates at the distances `at` (m+1,) [m] along the line, between which the integrator takes `substeps`."""

    line: Line
    at: Array
    gates: Gates
    substeps: int

    @property
    def intervals(self) -> int:
        """m."""
        return len(self.at) - 1

    def inset(self, low: Array, high: Array) -> Mesh:
        """With gates narrower by `low`, `high` (m+1,) [m] on the right and on the left, as far as there is room."""
        gates = self.gates
        room = np.maximum(gates.high - gates.low, 0.0)
        share = np.minimum(1.0, 0.9 * room / np.maximum(low + high, 1e-9))
        return replace(self, gates=replace(gates, low=gates.low + share * low, high=gates.high - share * high))


def mesh(line: Line, v: Array, finer: float = 1.0, substeps: int = 2, least: int = 0) -> Mesh:
    """Gates along the line, on which the car is about `v` (n,) [m/s] fast.

    With at least `least` intervals; everything aimed at is divided by `finer`.
    """
    h = np.clip(np.sqrt(_BOW / np.maximum(_bulge(line), 1e-9)), _ROUGH, FARTHEST)
    h = np.clip(np.minimum(h, substeps * v**2 / _STABLE) / finer, NEAREST / max(finer, 1.0), None)
    h = gradual(h, line.s, line.closed)
    passed = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(line.s) * (1 / h[1:] + 1 / h[:-1]))])
    m = _SHARED * int(np.ceil(max(passed[-1], least) / _SHARED))
    at = np.interp(np.linspace(0.0, passed[-1], m + 1), passed, line.s)
    made = Mesh(line, at, line.gates(at), substeps)
    bows = _bows(made)
    return made.inset(*(np.minimum(_at_gates(bow, line.closed), _MOST_INSET) for bow in bows))


def _bulge(line: Line) -> Array:
    """(n,) [1/m]: how much more than the path an edge bends into the road, over 8: times l^2 it is the bow on l."""
    bends = []
    for edge, side in zip(line.edges(), (1, -1), strict=True):
        change = np.diff(edge, axis=0)
        ahead = np.sum(change * (line.points[1:] - line.points[:-1]), axis=1) > 0
        length = np.maximum(np.hypot(*change.T), 0.2)
        course = np.unwrap(np.arctan2(change[:, 1], change[:, 0]))
        bend = np.zeros(len(line.s))
        bend[1:-1] = np.diff(course) / (0.5 * (length[1:] + length[:-1])) * (ahead[1:] & ahead[:-1])
        bends.append(np.maximum(side * bend, 0.0))
    own = _PATH * np.minimum(np.abs(line.curvature), _SHARPEST)
    sharp = np.maximum(np.maximum(*bends) - own, 0.0)
    window = max(3, round(8.0 * len(line.s) / line.length))
    smooth = np.convolve(sharp, np.ones(window) / window, mode="same")
    return np.asarray(maximum_filter1d(smooth, window)) / 8


def _bows(made: Mesh) -> tuple[Array, Array]:
    """(m,) [m] for the right and the left: how far the edge bows into the road over the chord, less the path's bow."""
    line, at, gates = made.line, made.at, made.gates
    k = np.clip(np.searchsorted(at, line.s, side="right") - 1, 0, made.intervals - 1)
    length = np.diff(at)
    kappa = np.maximum.reduceat(np.abs(line.curvature), np.minimum(np.searchsorted(line.s, at[:-1]), len(line.s) - 1))
    own = _PATH * np.minimum(kappa, _SHARPEST) * length**2 / 8
    bows = []
    for edge, side, ends in zip(line.edges(), (-1, 1), (gates.point(gates.high), gates.point(gates.low)), strict=True):
        start, chord = ends[:-1][k], np.diff(ends, axis=0)[k]
        away = edge - start
        across = (chord[:, 0] * away[:, 1] - chord[:, 1] * away[:, 0]) / np.maximum(np.hypot(*chord.T), 1e-9)
        bow = np.zeros(made.intervals)
        np.maximum.at(bow, k, side * across)
        bows.append(np.maximum(bow - own, 0.0))
    return bows[1], bows[0]


def _at_gates(of_intervals: Array, closed: bool) -> Array:
    """(m+1,) the larger value (m,) of the two intervals beside each gate."""
    ends = (of_intervals[-1:], of_intervals[:1]) if closed else (of_intervals[:1], of_intervals[-1:])
    return np.maximum(np.concatenate([ends[0], of_intervals]), np.concatenate([of_intervals, ends[1]]))
