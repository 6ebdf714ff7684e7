"""Where the search of a local problem begins: at the tail of the problem before, and beyond it along the road."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..frames import into_frames, out_of_frames
from .layout import INPUTS, STATES
from .memory import Tail
from .search import Ahead, LocalNodes
from .speed import SLOWEST

Array = NDArray[np.float64]
_GAIN, _BRAKE = 2.0, 5.0
"""Accelerations [m/s2] of the guessed speed (engineering choice)."""


def guess(ahead: Ahead, tail: Tail, drive: float) -> LocalNodes:
    """The tail, continued: to the middle of the road, the speed changing gently, with the rear force `drive` [N]."""
    frames, N = ahead.gates.frames, len(ahead.fastest) - 1
    known = min(len(tail.T), N)
    x = np.zeros((STATES, N + 1))
    world = np.vstack([ahead.start, tail.x[:known]])
    x[:, : known + 1] = into_frames(world.T, frames[: known + 1])
    _along(x[:, known:], ahead, known)
    u = np.tile([0.0, 0.0, drive], (N, 1))
    u[:known] = tail.u[:known]
    T = 2 * np.hypot(*ahead.gates.steps[:, :2].T) / (x[2, 1:] + x[2, :-1])
    T[:known] = tail.T[:known]
    assert u.shape == (N, INPUTS)
    return LocalNodes(out_of_frames(x, frames).T, u, T)


def _along(x: Array, ahead: Ahead, known: int) -> None:
    """Fill in the states after the first, which lies on gate `known`.

    The speed rises gently and brakes, a little harder, only at gates where `ahead.fastest` is less.
    """
    count = x.shape[1] - 1
    if count == 0:
        return
    length = np.hypot(*ahead.gates.steps[known:, :2].T)
    middle = 0.5 * (ahead.gates.low + ahead.gates.high)[known + 1 :]
    fade = np.linspace(1, 0, count + 1)[1:]
    x[1, 1:] = fade * x[1, 0] + (1 - fade) * middle
    for k in range(count):
        square = x[2, k] ** 2
        least, most = np.sqrt(max(square - 2 * _BRAKE * length[k], SLOWEST**2)), np.sqrt(square + 2 * _GAIN * length[k])
        x[2, k + 1] = np.clip(ahead.fastest[known + k + 1], least, most)
    x[5, 1:] = ahead.curvature[known + 1 :] * x[2, 1:]
