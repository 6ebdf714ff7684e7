"""Time grid, the form of the thesis: m equal intervals of the free end time, the road an inequality at every node."""

from __future__ import annotations

import casadi as ca
import numpy as np

from fmus.planner.blocks import shots, with_derivatives
from fmus.planner.gates import Array
from fmus.planner.program import Ends, NonlinearProgram, decision, limits, roughness, scaled, state_bounds
from fmus.planner.road import Corridor
from fmus.planner.vehicle import Vehicle

_SHORTEST, _LONGEST = 1.0, 60.0


def program(
    vehicle: Vehicle, road: Corridor, m: int, ends: Ends, *, substeps: int, smoothing: float
) -> NonlinearProgram:
    """Minimise the end time plus `smoothing` times the roughness of the inputs; the variable is T = end time / m."""
    s = decision(vehicle, m, 1)
    gaps = shots(vehicle, s, ca.DM.zeros(3, m), substeps)
    beside = _beside(road).map(m + 1)(s.x[0, :], s.x[1, :])
    own = limits(vehicle, s)
    rest = ca.vertcat(ca.vec(beside), own)
    g = ca.vertcat(gaps.gaps, rest)
    nlp = {"x": s.column, "f": m * s.T + smoothing * roughness(s), "g": g, "p": ca.MX(0, 1)}
    lower, upper = _bounds(vehicle, road, m, ends)
    equalities = gaps.gaps.numel()
    least = np.concatenate([np.zeros(equalities), np.full(g.numel() - equalities, -np.inf)])
    frames, exact = np.zeros((m + 1, 3)), with_derivatives(nlp, gaps, rest)
    return NonlinearProgram(nlp, lower, upper, least, np.zeros(g.numel()), np.zeros(0), frames, vehicle, 1, exact)


def _beside(road: Corridor) -> ca.Function:
    """(x, y) -> distances [m] outside the lower and the upper limit; must not be positive."""
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    low, high = road.limits()(x)
    return ca.Function("beside", [x, y], [ca.vertcat(low - y, y - high)], {"never_inline": True})


def _bounds(vehicle: Vehicle, road: Corridor, m: int, ends: Ends) -> tuple[Array, Array]:
    low, high = state_bounds(vehicle, road.gates(m), ends)
    low[0], high[0] = road.start, road.end
    low[0, -1], high[0, 0] = road.end, road.start
    shortest, longest = (np.array([end / m]) for end in (_SHORTEST, _LONGEST))
    return scaled(vehicle, low, vehicle.input_lower, shortest), scaled(vehicle, high, vehicle.input_upper, longest)
