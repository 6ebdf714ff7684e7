"""Gate grid: node k lies on gate k, the interval lengths are free, and the road is a bound on the lateral position.

Each state is written in the frame of its gate, so that any road, also one that crosses itself, looks the same.
"""

from __future__ import annotations

import casadi as ca
import numpy as np

from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends, Program, decision, limits, roughness, scaled, state_bounds
from fmus.planner.shooting import interval
from fmus.planner.vehicle import Vehicle

_SHORTEST, _LONGEST = 1e-3, 2.0
_TURN = 1.2
"""Largest angle of the car to the road [rad]."""


def program(vehicle: Vehicle, gates: Gates, ends: Ends, *, substeps: int, smoothing: float) -> Program:
    """Minimise the sum of the interval lengths plus `smoothing` times the roughness of the inputs."""
    m = len(gates.frames) - 1
    s, steps = decision(vehicle, m, m), ca.MX.sym("steps", 3, m)
    gaps = _gap(vehicle, substeps).map(m)(s.x[:, :-1], s.u, s.T, s.X[:, 1:], steps)
    own = limits(vehicle, s)
    turn = s.X[2:, -1] - s.X[2:, 0] if gates.closed else ca.MX(0, 1)
    side = s.X[1, -1] - s.X[1, 0] if gates.closed else ca.MX(0, 1)
    g = ca.vertcat(ca.vec(gaps), side, turn, own)
    nlp = {"x": s.column, "f": ca.sum2(s.T) + smoothing * roughness(s), "g": g, "p": ca.vec(steps)}
    lower, upper = _bounds(vehicle, gates, ends)
    free = np.zeros(g.numel())
    least = np.concatenate([np.zeros(g.numel() - own.numel()), np.full(own.numel(), -np.inf)])
    return Program(nlp, lower, upper, least, free, gates.steps.ravel(), gates.frames, vehicle, m)


def _gap(vehicle: Vehicle, substeps: int) -> ca.Function:
    """(x, u, T, next scaled state, step to the next gate) -> scaled difference of the end state and the next state."""
    scale, end = ca.DM(vehicle.scale), interval(vehicle.f, substeps)
    x, u, T = ca.MX.sym("x", 7), ca.MX.sym("u", len(vehicle.input_scale)), ca.MX.sym("T")
    following, step = ca.MX.sym("next", 7), ca.MX.sym("step", 3)
    reached = end(x, u, T)
    away, c, s = reached[:2] - step[:2], ca.cos(step[2]), ca.sin(step[2])
    local = ca.vertcat(
        c * away[0] + s * away[1], c * away[1] - s * away[0], reached[2:4], reached[4] - step[2], reached[5:]
    )
    return ca.Function("gap", [x, u, T, following, step], [local / scale - following])


def _bounds(vehicle: Vehicle, gates: Gates, ends: Ends) -> tuple[Array, Array]:
    low, high = state_bounds(vehicle, gates, ends)
    low[0], high[0] = 0.0, 0.0
    low[1], high[1] = np.fmax(low[1], gates.low), np.fmin(high[1], gates.high)
    low[4], high[4] = np.fmax(low[4], -_TURN), np.fmin(high[4], _TURN)
    m = low.shape[1] - 1
    return scaled(vehicle, low, vehicle.input_lower, np.full(m, _SHORTEST)), scaled(
        vehicle, high, vehicle.input_upper, np.full(m, _LONGEST)
    )
