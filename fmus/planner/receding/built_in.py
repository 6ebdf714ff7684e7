"""The built-in road: 690 m with curves of 60, 25, 40 and 80 m radius and 3 m to both sides (an engineering choice)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

_CURVATURE = (
    *((0.0, 0.0), (90.0, 0.0), (110.0, 1 / 60), (150.0, 1 / 60), (170.0, 0.0)),
    *((240.0, 0.0), (255.0, -1 / 25), (285.0, -1 / 25), (300.0, 0.0)),
    *((330.0, 0.0), (345.0, 1 / 40), (390.0, 1 / 40), (405.0, 0.0)),
    *((500.0, 0.0), (520.0, -1 / 80), (580.0, -1 / 80), (600.0, 0.0), (690.0, 0.0)),
)
"""(distance [m], curvature [1/m]), linear in between: straights, clothoids and circles."""
_HALF_WIDTH = 3.0
_SPACING, _FINE = 5.0, 0.01


def rows() -> NDArray[np.float64]:
    """(139, 4): x, y, width_left, width_right [m] every 5 m, from the origin eastwards."""
    knots = np.array(_CURVATURE)
    s = np.arange(round(knots[-1, 0] / _FINE) + 1) * _FINE
    kappa = np.interp(s, *knots.T)
    heading = np.concatenate([[0.0], np.cumsum(0.5 * (kappa[1:] + kappa[:-1]) * _FINE)])
    middle = 0.5 * (heading[1:] + heading[:-1])
    steps = _FINE * np.column_stack([np.cos(middle), np.sin(middle)])
    points = np.vstack([[0.0, 0.0], np.cumsum(steps, axis=0)])[:: round(_SPACING / _FINE)]
    return np.column_stack([points, np.full((len(points), 2), _HALF_WIDTH)])
