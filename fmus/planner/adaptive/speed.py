"""About how fast a car drives along a line: a guess that places gates and begins searches."""

from __future__ import annotations

import numpy as np

from fmus.planner.gates import Array

LATERAL, GAIN, BRAKE = 5.5, 3.5, 5.0
"""Accelerations [m/s2]: across, gaining speed, braking (engineering choices for any of our cars)."""


def profile(s: Array, curvature: Array, fastest: float, first: float = np.nan, *, closed: bool) -> Array:
    """Speeds (n,) [m/s] at the distances `s` (n,) [m], by a forward and a backward pass under a friction ellipse.

    `first` is the speed at the start of an open line, NaN any. What a curve takes is not there for gaining or braking.
    """
    bend = np.maximum(np.abs(curvature), LATERAL / fastest**2)
    squares, length = LATERAL / bend, np.diff(s)
    if not np.isnan(first):
        squares[0] = first**2
    for _ in range(2 if closed else 1):
        for step, gained, order in ((1, GAIN, range(1, len(s))), (-1, BRAKE, range(len(s) - 2, -1, -1))):
            for k in order:
                left = 1 - (squares[k - step] * bend[k] / LATERAL) ** 2
                way = length[min(k, k - step)]
                squares[k] = min(squares[k], squares[k - step] + 2 * gained * way * np.sqrt(max(left, 0.0)))
            if closed:
                squares[[0, -1]] = squares[[0, -1]].min()
    return np.asarray(np.sqrt(squares))
