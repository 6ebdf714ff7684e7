"""States in the world, and in frames along a road. Imports nothing of ours: it travels inside an FMU."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def into_frames(x: Array, frames: Array) -> Array:
    """States (7, n) of the world in the frames (n, 3)."""
    result, away, heading = x.copy(), x[:2] - frames[:, :2].T, frames[:, 2]
    c, s = np.cos(heading), np.sin(heading)
    result[0], result[1] = c * away[0] + s * away[1], c * away[1] - s * away[0]
    result[4] -= heading
    return result


def out_of_frames(x: Array, frames: Array) -> Array:
    """States (7, n) of the frames (n, 3) in the world."""
    result, heading = x.copy(), frames[:, 2]
    c, s = np.cos(heading), np.sin(heading)
    result[0] = frames[:, 0] + c * x[0] - s * x[1]
    result[1] = frames[:, 1] + s * x[0] + c * x[1]
    result[4] += heading
    return result
