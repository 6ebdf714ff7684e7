"""Where a follower was commanded to be, and whether it kept to that: its own offset is no measure of itself.

A follower smooths what it is commanded, and one far from its place leads itself back along an offset it chooses. The
course commanded is computed anew here, from the commands alone: a quintic of `formation.duration` from the present
(r, r', r'') to each new place at rest, moved back by headway times speed. The offset the follower gives counts as the
place wanted as long as it is that course; elsewhere the course itself does, and the follower is leading itself back.
"""

from __future__ import annotations

import numpy as np
from numpy.polynomial import Polynomial

from cosim.model.signals import Vector

ALLOWED = 1.0
"""Distance [m] of the offset from the course commanded up to which it is the same: ten times what they differ by while
a place is changed (engineering choice)."""
_MEMORY = 1.0
"""How far [s] from the true speed the one may be that a follower takes for its own in the headway; its filters and the
lag of its speed are faster."""


def jumps(command: Vector) -> np.ndarray:
    """The rows at which `command` (n, 2) is another than before."""
    return np.flatnonzero(np.any(np.diff(command, axis=0) != 0.0, axis=1)) + 1


def course(time: Vector, command: Vector, duration: float) -> Vector:
    """The offsets (n, 2) [m] from place to place of `command` (n, 2), each reached `duration` [s] after its jump."""
    found = np.array(command, dtype=float)
    now = np.array([command[0], [0.0, 0.0], [0.0, 0.0]]) if len(command) else np.zeros((3, 2))
    begins = jumps(command)
    for begin, end in zip(begins, [*begins[1:], len(time)], strict=False):  # no jump, no move
        elapsed = np.minimum(time[begin:] - time[begin], duration)
        moves = [_quintic(now[:, axis], command[begin, axis], duration) for axis in (0, 1)]
        found[begin:end] = np.stack([move(elapsed[: end - begin]) for move in moves], -1)
        if end < len(time):
            now = np.array([[move.deriv(order)(elapsed[end - begin]) for move in moves] for order in (0, 1, 2)])
    return found


def _quintic(begin: Vector, target: float, duration: float) -> Polynomial:
    """From (r, r', r'') to rest at `target` after `duration` [s]."""
    known = begin / [1.0, 1.0, 2.0]
    T = duration
    ends = np.array([[T**3, T**4, T**5], [3 * T**2, 4 * T**3, 5 * T**4], [6 * T, 12 * T**2, 20 * T**3]])
    free = Polynomial(known)
    rest = np.array([target - free(T), -free.deriv(1)(T), -free.deriv(2)(T)])
    return Polynomial([*known, *np.linalg.solve(ends, rest)])


def wanted(time: Vector, own: Vector, moving: Vector, speed: Vector, headway: float) -> tuple[Vector, np.ndarray]:
    """The offsets (n, 2) [m] a follower was wanted at, and where (n,) those it gave, `own`, were others.

    `moving` is the course commanded, `speed` (n,) [m/s] the true one. A follower that has given no output yet, all of
    `own` being zero, is not one that leads itself elsewhere.
    """
    commanded = moving - headway * np.stack((speed, 0 * speed), -1)
    silent = np.cumsum(np.any(own != 0.0, axis=1)) == 0
    slow, fast = _range(time, speed)
    nearest = np.clip(own[:, 0], moving[:, 0] - headway * fast, moving[:, 0] - headway * slow)
    far = np.hypot(own[:, 0] - nearest, own[:, 1] - moving[:, 1]) > ALLOWED
    return np.where(far[:, None], commanded, own), far & ~silent


def _range(time: Vector, speed: Vector) -> tuple[Vector, Vector]:
    """The lowest and the highest speed (n,) within `_MEMORY` of each time; rows are evenly spaced."""
    if len(time) < 2:
        return speed, speed
    reach = int(np.ceil(_MEMORY / (time[1] - time[0])))
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(speed, reach, mode="edge"), 2 * reach + 1)
    return windows.min(axis=1), windows.max(axis=1)
