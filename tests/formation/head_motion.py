"""How the head of a chain moves, as deviations from a steady drive."""

from __future__ import annotations

import numpy as np
from chain_model import Motion

from scenarios.platoon.excitation import LINES, PERIOD, multisine, straight

OMEGA = 2 * np.pi * np.array(LINES) / PERIOD
SETTLE = 30.0
"""When [s] the answer to the sweep has become periodic."""
_TIME = 0.01 * np.arange(round(100 * (SETTLE + PERIOD)) + 2)


def swept(acceleration: float) -> Motion:
    """The multi-sine; `acceleration` [m/s2] is its root mean square."""
    rows = straight(_TIME, *multisine(_TIME, acceleration))
    return lambda t: (float(np.interp(t, _TIME, rows[:, 1])), float(np.interp(t, _TIME, rows[:, 4])))


def braking(t: float) -> tuple[float, float]:
    """The head takes back 8 m/s with 4 m/s2 after 2 s, and accelerates again after 15 s."""
    knots, speeds, ways = (np.array(v) for v in ([0, 2, 4, 15, 19], [0.0, 0, -8, -8, 0], [0.0, 0, -8, -96, -112]))
    speed = np.interp(t, knots, speeds)
    i = int(np.clip(np.searchsorted(knots, t, side="right") - 1, 0, 4))
    return float(ways[i] + 0.5 * (speeds[i] + speed) * (t - knots[i])), float(speed)
