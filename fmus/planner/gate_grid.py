"""Gate grid: node k lies on gate k, the interval lengths are free, and the road is a bound on the lateral position.

Each state is written in the frame of its gate, so that any road, also one that crosses itself, looks the same.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from fmus.planner.blocks import shots, with_derivatives
from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends, NonlinearProgram, decision, limits, roughness, scaled, state_bounds
from fmus.planner.vehicle import Vehicle

_SHORTEST, _LONGEST = 1e-3, 2.0
"""Lengths of an interval [s]; longer where the gates are so far apart that the car may need more."""
_SPEED, _TURN = 2, 1.2
"""The state that is the speed; largest angle of the car to the road [rad]."""


def program(vehicle: Vehicle, gates: Gates, ends: Ends, *, substeps: int, smoothing: float) -> NonlinearProgram:
    """Minimise the sum of the interval lengths plus `smoothing` times the roughness of the inputs."""
    m = len(gates.frames) - 1
    s, steps = decision(vehicle, m, m), ca.MX.sym("steps", 3, m)
    gaps = shots(vehicle, s, steps, substeps)
    own = limits(vehicle, s)
    turn = s.X[2:, -1] - s.X[2:, 0] if gates.closed else ca.MX(0, 1)
    side = s.X[1, -1] - s.X[1, 0] if gates.closed else ca.MX(0, 1)
    rest = ca.vertcat(side, turn, own)
    g = ca.vertcat(gaps.gaps, rest)
    nlp = {"x": s.column, "f": ca.sum2(s.T) + smoothing * roughness(s), "g": g, "p": ca.vec(steps)}
    lower, upper = _bounds(vehicle, gates, ends)
    free = np.zeros(g.numel())
    least = np.concatenate([np.zeros(g.numel() - own.numel()), np.full(own.numel(), -np.inf)])
    return NonlinearProgram(
        nlp, lower, upper, least, free, gates.steps.ravel(), gates.frames, vehicle, m, with_derivatives(nlp, gaps, rest)
    )


def _bounds(vehicle: Vehicle, gates: Gates, ends: Ends) -> tuple[Array, Array]:
    low, high = state_bounds(vehicle, gates, ends)
    low[0], high[0] = 0.0, 0.0
    low[1], high[1] = np.fmax(low[1], gates.low), np.fmin(high[1], gates.high)
    low[4], high[4] = np.fmax(low[4], -_TURN), np.fmin(high[4], _TURN)
    longest = np.fmax(_LONGEST, 1.5 * np.hypot(*gates.steps[:, :2].T) / vehicle.lower[_SPEED])
    shortest = np.full(len(longest), _SHORTEST)
    return scaled(vehicle, low, vehicle.input_lower, shortest), scaled(vehicle, high, vehicle.input_upper, longest)
