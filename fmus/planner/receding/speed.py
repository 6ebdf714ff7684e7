"""How fast the car may be at the end of a local problem: what the road beyond it allows."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
SLOWEST = 3.0
"""The car's model is not valid below this speed [m/s]."""
MARGIN = 1.1
"""A horizon must be longer than the braking distance by this factor."""


def profile(curvature: Array, spacing: Array | float, lateral: float, braking: float, end: float) -> Array:
    """Highest speeds (n,) at gates `spacing` (n-1,) [m] apart with `end` [m/s] at the last, by a backward pass.

    v_j^2 = min(a_y/|kappa_j|, v_{j+1}^2 + 2 a ds), a = a_b sqrt(1 - (v_{j+1}^2 max(kappa_j, kappa_{j+1})/a_y)^2): what
    the curve takes is not there for braking. Not below SLOWEST; `lateral` a_y, `braking` a_b [m/s2].
    """
    bend = np.maximum(np.abs(curvature), 1e-9)
    squares = lateral / bend
    squares[-1] = min(squares[-1], end**2)
    length = np.broadcast_to(spacing, len(squares) - 1)
    for j in range(len(squares) - 2, -1, -1):
        used = min(squares[j + 1] * max(bend[j], bend[j + 1]) / lateral, 1.0)
        squares[j] = min(squares[j], squares[j + 1] + 2 * braking * length[j] * np.sqrt(1 - used**2))
    return np.maximum(np.sqrt(squares), SLOWEST)


def within_horizon(last: float, length: float, braking: float) -> float:
    """The speed [m/s] from which the car can brake to `last` on `length` [m], MARGIN kept."""
    return float(np.sqrt(last**2 + 2 * braking * length / MARGIN))
