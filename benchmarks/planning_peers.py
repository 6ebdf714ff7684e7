"""The plan on the gate grid as a user of CasADi would write it, and as fatrop takes it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import casadi as ca
import numpy as np

from fmus.cars.published import single_track
from fmus.planner.gates import Array
from fmus.planner.hocp import PlanSettings
from fmus.planner.program import Nodes, standing_ends, state_bounds
from fmus.planner.road import double_lane_change
from fmus.planner.shooting import interval
from fmus.planner.vehicle import two_wheel_drive

ROAD, CAR, ENDS, HOW = double_lane_change(), two_wheel_drive(single_track()), standing_ends(), PlanSettings()

Run = Callable[[], tuple[dict[str, Any], float]]
"""A solution: the solver's statistics and the end time [s]."""

_EVERYWHERE = (-np.inf, np.inf)
_LENGTHS = (1e-3, 2.0)
_INPUT_BOUNDS = (CAR.input_lower / CAR.input_scale, CAR.input_upper / CAR.input_scale)


def opti(m: int, first: Nodes) -> Run:
    """The gate grid, one constraint after the other."""
    problem, step = ca.Opti(), _step()
    X, U, T = problem.variable(7, m + 1), problem.variable(3, m), problem.variable(m)
    problem.minimize(ca.sum1(T) + HOW.smoothing * ca.sumsqr(U[:, 1:] - U[:, :-1]))
    low, high = _bounds(m)
    for k in range(m):
        problem.subject_to(step(X[:, k], U[:, k], T[k]) == X[:, k + 1])
        problem.subject_to(problem.bounded(_INPUT_BOUNDS[0], U[:, k], _INPUT_BOUNDS[1]))
        problem.subject_to(problem.bounded(_LENGTHS[0], T[k], _LENGTHS[1]))
    for i, k in np.argwhere(np.isfinite(low)).tolist():
        problem.subject_to(problem.bounded(low[i, k], X[i, k], high[i, k]))
    for variable, value in zip((X, U, T), _start(first), strict=True):
        problem.set_initial(variable, value)
    problem.solver("ipopt", {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": HOW.tolerance}})

    def run() -> tuple[dict[str, Any], float]:
        found = problem.solve()
        return found.stats(), float(np.sum(found.value(T)))

    return run


def fatrop(m: int, first: Nodes) -> Run:
    """The gate grid stage by stage; the last inputs are states too, for the changes of the inputs in the objective."""
    X0, U0, T0 = _start(first)
    low, high = (
        np.vstack([bound, np.full((3, m + 1), end)]) for bound, end in zip(_bounds(m), _EVERYWHERE, strict=True)
    )
    fixed, values = low == high, low.copy()
    low[fixed], high[fixed] = _EVERYWHERE
    lowest, highest = (np.tile(np.append(u, T)[:, None], m) for u, T in zip(_INPUT_BOUNDS, _LENGTHS, strict=True))
    x, u = ([ca.MX.sym("v", size) for _ in range(m + 1)] for size in (10, 4))
    g = _stage_constraints(x, u[:m], fixed, values)
    changes = sum(ca.sumsqr(one[:3] - state[7:]) for one, state in zip(u[1:m], x[1:m], strict=True))
    cost = sum(one[3] for one in u[:m]) + HOW.smoothing * changes
    stages = [part for pair in zip(x, u, strict=True) for part in pair][:-1]
    nlp = {"x": ca.veccat(*stages), "f": cost, "g": g}
    options = {"structure_detection": "auto", "equality": [True] * g.numel(), "print_time": False}
    solver = ca.nlpsol("plan", "fatrop", nlp, options | {"fatrop": {"print_level": 0, "tol": HOW.tolerance}})
    before = np.vstack([X0, np.column_stack([U0[:, :1], U0])])
    start = {"x0": _staged(before, np.vstack([U0, T0])), "lbx": _staged(low, lowest), "ubx": _staged(high, highest)}

    def run() -> tuple[dict[str, Any], float]:
        w = solver(**start, lbg=0, ubg=0)["x"].full().ravel()
        if not solver.stats()["success"]:
            raise RuntimeError("fatrop found no plan")
        return solver.stats(), float(w[13::14].sum())

    return run


def _stage_constraints(x: list[ca.MX], u: list[ca.MX], fixed: Array, values: Array) -> ca.MX:
    """Stage by stage as fatrop wants them: the next state less what leads to it, then the states that are given."""
    step, parts = _step(), []
    for k, state in enumerate(x):
        if k < len(u):
            parts.append(x[k + 1] - ca.vertcat(step(state[:7], u[k][:3], u[k][3]), u[k][:3]))
        parts.append(state[np.flatnonzero(fixed[:, k]).tolist()] - values[fixed[:, k], k])
    return ca.vertcat(*parts)


def _staged(x: Array, u: Array) -> Array:
    """x_0, u_0, x_1, u_1, ... in one column."""
    return np.append(np.vstack([x[:, :-1], u]).ravel("F"), x[:, -1])


def _step() -> ca.Function:
    """(scaled state, scaled input, T) -> scaled state at the end of an interval."""
    X, U, T = ca.MX.sym("X", 7), ca.MX.sym("U", 3), ca.MX.sym("T")
    end = interval(CAR.f, HOW.substeps)(CAR.scale * X, CAR.input_scale * U, T)
    return ca.Function("step", [X, U, T], [end / CAR.scale])


def _bounds(m: int) -> tuple[Array, Array]:
    """Of the scaled states (7, m+1) in the world, positions on their gates."""
    gates = ROAD.gates(m)
    low, high = state_bounds(CAR, gates, ENDS)
    low[0] = high[0] = gates.frames[:, 0]
    low[1], high[1] = gates.low, gates.high
    return low / CAR.scale[:, None], high / CAR.scale[:, None]


def _start(first: Nodes) -> tuple[Array, Array, Array]:
    return first.x / CAR.scale[:, None], first.u / CAR.input_scale[:, None], first.T
