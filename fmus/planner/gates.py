"""A road as the planner sees it: gates across it, each a line with the part the centre of gravity may cross.

Its import is relative because it travels inside an FMU.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .errors import PlanningError

Array = NDArray[np.float64]
_SLOPE = 0.15
"""Largest change of the distance of gates per metre (engineering choice)."""
_PART = 0.9
"""How near to the crossing with their neighbours gates may reach."""
_LOST = 0.5
"""Part of the width inside a bend that must be left."""


@dataclass(frozen=True, slots=True)
class Gates:
    """n gates: `frames` (n, 3) position x, y [m] and continuous heading [rad]; `low`, `high` (n,) [m], lateral.

    Lateral positions count to the left of the frame's origin. `closed`: the last gate is the first.
    """

    frames: Array
    low: Array
    high: Array
    closed: bool = False

    @property
    def steps(self) -> Array:
        """(n-1, 3) each gate as seen from the one before: displacement forward and left [m], turn [rad]."""
        change, heading = np.diff(self.frames, axis=0), self.frames[:-1, 2]
        c, s = np.cos(heading), np.sin(heading)
        forward, left = c * change[:, 0] + s * change[:, 1], c * change[:, 1] - s * change[:, 0]
        return np.column_stack([forward, left, change[:, 2]])

    def point(self, lateral: Array) -> Array:
        """(n, 2) points at the lateral positions (n,)."""
        heading = self.frames[:, 2]
        return self.frames[:, :2] + np.column_stack([-np.sin(heading), np.cos(heading)]) * lateral[:, None]


def checked(gates: Gates) -> Gates:
    """The gates, if a car fits through each and none crosses the next within the road; else raises PlanningError."""
    check_widths(gates)
    steps, turn = gates.steps, np.sin(gates.steps[:, 2])
    for edge in (gates.low, gates.high):
        ahead = steps[:, 0] - turn * edge[1:]
        if (ahead <= 0).any():
            raise _too_sharp(gates, int(np.argmin(ahead)))
    return gates


def uncrossed(gates: Gates) -> Gates:
    """Gates whose parts inside the road do not cross from one to the next: on the inside of sharp bends less of it.

    Raises PlanningError where half of the inside would be lost: that is no width of a road.
    """
    low, high, steps = gates.low.copy(), gates.high.copy(), gates.steps
    turn = np.sin(steps[:, 2])
    with np.errstate(divide="ignore"):
        reach = _PART * steps[:, 0] / np.abs(turn)
    for edge, side in ((high, 1), (low, -1)):
        inside = np.where(side * turn > 0, reach, np.inf)
        most = np.minimum(np.append(inside, np.inf), np.append(np.inf, inside))
        if gates.closed:
            most[[0, -1]] = most[[0, -1]].min()
        if (most < _LOST * side * edge).any():
            raise _too_sharp(gates, int(np.argmax(side * edge / most)))
        edge[:] = side * np.minimum(side * edge, most)
    return Gates(gates.frames, low, high, gates.closed)


def check_widths(gates: Gates) -> None:
    """Raise PlanningError naming the narrowest gate, if the car does not fit through it."""
    width = gates.high - gates.low
    k = int(np.argmin(width))
    if width[k] < 0:
        x, y = gates.point(0.5 * (gates.low + gates.high))[k]
        raise PlanningError(
            f"the corridor is narrower than the car by {-width[k]:.2f} m near x = {x:.1f} m, y = {y:.1f} m, "
            f"{_along(gates, k):.0f} m along the road; widen it or reduce the clearance"
        )


def _too_sharp(gates: Gates, k: int) -> PlanningError:
    x, y = gates.frames[k, :2]
    return PlanningError(
        f"the road turns too sharply for its width near x = {x:.1f} m, y = {y:.1f} m, "
        f"{_along(gates, k):.0f} m along it; narrow it there, smooth the centre line or take fewer intervals"
    )


def _along(gates: Gates, k: int) -> float:
    """Distance [m] of gate k from the first, from gate to gate."""
    return float(np.sum(np.hypot(*np.diff(gates.frames[: k + 1, :2], axis=0).T)))


def gradual(h: Array, s: Array, closed: bool) -> Array:
    """Distances of gates (n,) [m] at s (n,) [m]: the largest below h that change by at most _SLOPE per metre."""
    h, step = h.copy(), _SLOPE * np.diff(s)
    for _ in range(2 if closed else 1):
        for k in range(1, len(h)):
            h[k] = min(h[k], h[k - 1] + step[k - 1])
        for k in range(len(h) - 2, -1, -1):
            h[k] = min(h[k], h[k + 1] + step[k])
        if closed:
            h[0] = h[-1] = min(h[0], h[-1])
    return h
