"""The double lane change: a corridor between two edges y(x), each a sum of smooth steps."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import casadi as ca
import numpy as np

from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array, Gates, check_widths, checked

Shape = Literal["smooth", "cubic"]
_NEAR = 0.1
"""Part of a transition between the places at which the width is checked."""
_OFFSET = 3.5
"""Lateral distance of the lower edge in the middle of the manoeuvre [m]."""


@dataclass(frozen=True, slots=True)
class Edge:
    """y = base + sum of rises [m], each a step centred at its x [m]."""

    base: float
    steps: tuple[tuple[float, float], ...]


@dataclass(frozen=True, slots=True)
class Corridor:
    """Where y must lie over x from `start` to `end` [m].

    Steps are `transition` long; the centre of gravity keeps `clearance` from both edges [m].
    """

    start: float
    end: float
    lower: Edge
    upper: Edge
    transition: float
    clearance: float
    shape: Shape = "smooth"

    def __post_init__(self) -> None:
        if not self.transition > 0:
            raise PlanningError(f"the transition length is {self.transition:g} m; give a positive length")
        if not self.clearance >= 0:
            raise PlanningError(f"the clearance is {self.clearance:g} m; give zero or a positive distance")

    def limits(self) -> ca.Function:
        """x -> lowest and highest y [m] of the centre of gravity."""
        x = ca.SX.sym("x")
        low, high = self._edge(self.lower, x) + self.clearance, self._edge(self.upper, x) - self.clearance
        return ca.Function("limits", [x], [low, high], ["x"], ["low", "high"])

    def gates(self, m: int) -> Gates:
        """m + 1 gates at equal distances; between them the widths are checked too."""
        check_widths(self._across(np.arange(self.start, self.end, _NEAR * self.transition)))
        return checked(self._across(np.linspace(self.start, self.end, m + 1)))

    def _across(self, x: Array) -> Gates:
        low, high = _evaluate(self.limits(), x)
        return Gates(np.column_stack([x, 0 * x, 0 * x]), low, high)

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which the points (n, 2) leave the corridor; 0 inside."""
        low, high = _evaluate(self.limits(), points[:, 0])
        return float(max(0.0, np.max(low - points[:, 1]), np.max(points[:, 1] - high)))

    def _edge(self, edge: Edge, x: ca.SX) -> ca.SX:
        step = _smooth if self.shape == "smooth" else _cubic
        y = ca.SX(edge.base)
        for at, rise in edge.steps:
            y += rise * step((x - at) / self.transition + 0.5)
        return y


def double_lane_change(
    transition: float = 5.0, clearance: float = 0.84, width: float | None = None, shape: Shape = "smooth"
) -> Corridor:
    """Gates of ISO 3888-1 for a car of `width` B [m] (default twice the clearance); start at x = -30 m, end at 140 m.

    Transitions are centred at x = 15.5 and 94.5 m (upper edge), 44.5 and 70.5 m (lower edge). A transition of 1 m,
    clearance 0.75 m, width 1.5 m and `cubic` shape is the published test drive.
    """
    B = 2 * clearance if width is None else width
    h1, h3, h4 = 1.1 * B + 0.25, 1.2 * B + 3.75, 1.3 * B + 0.25
    lower = Edge(0.0, ((44.5, _OFFSET), (70.5, -_OFFSET)))
    upper = Edge(h1, ((15.5, h3 - h1), (94.5, h4 - h3)))
    return Corridor(-30.0, 140.0, lower, upper, transition, clearance, shape)


def _smooth(s: ca.SX) -> ca.SX:
    s = ca.fmin(ca.fmax(s, 0), 1)
    return s**3 * (10 - 15 * s + 6 * s**2)


def _cubic(s: ca.SX) -> ca.SX:
    s = ca.fmin(ca.fmax(s, 0), 1)
    return ca.if_else(s < 0.5, 4 * s**3, 1 + 4 * (s - 1) ** 3)


def _evaluate(limits: ca.Function, x: Array) -> tuple[Array, Array]:
    low, high = limits.map(len(x))(x[None, :])
    return low.full().ravel(), high.full().ravel()
