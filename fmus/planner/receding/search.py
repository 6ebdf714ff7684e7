"""One local problem: its bounds, where the search begins, and the search by IPOPT."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from time import perf_counter
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from ..frames import into_frames, out_of_frames
from ..gates import Gates
from .layout import CAR, INPUT_SCALE, INPUTS, NO_COMBINED_SLIP, SCALE, STATES, WEIGHTS
from .speed import SLOWEST

Array = NDArray[np.float64]
OPTIONS: dict[str, Any] = {
    "calc_lam_p": False,
    "print_time": False,
    "error_on_fail": False,
    "ipopt": {
        "print_level": 0,
        "sb": "yes",
        "tol": 1e-6,
        "max_iter": 150,
        "mu_strategy": "monotone",
        "mu_init": 1e-2,
        "warm_start_init_point": "yes",
        "bound_relax_factor": 0.0,
    },
}
"""A search that begins near its end: a small barrier from the start takes two thirds of the iterations. Bounds hold
exactly, since a node is the start of the next problem."""

_TURN = 0.8
"""Largest yaw angle of the car to the road [rad]."""
_COURSE, _YAW_RATE, _SIDESLIP = 0.05, 0.1, 0.15
"""At the last node: course to the road [rad], yaw rate to that of following the road [rad/s], sideslip [rad]
(engineering choice). The last two keep a problem from ending in a drift or a spin that the next one has to catch."""
_SOFT_COURSE, _SOFT_SIDE = 0.3, 10.0
_SHORTEST = 1e-3
_STATUS = {
    "Solve_Succeeded": 1,
    "Solved_To_Acceptable_Level": 2,
    "Maximum_Iterations_Exceeded": -1,
    "Infeasible_Problem_Detected": -2,
    "Restoration_Failed": -3,
}


@dataclass(frozen=True, slots=True)
class Tools:
    """The compiled solver and motion, see `local.py`; `horizon` N is the solver's."""

    solver: ca.Function
    motion: ca.Function
    horizon: int


@dataclass(frozen=True, slots=True)
class Ahead:
    """A local problem in world axes: the start (7,), the inputs before it (3,) and N + 1 gates, the first at the start.

    `fastest` (N+1,) [m/s] bounds the speed at the nodes; `curvature` (N+1,) [1/m] is that of the road.
    """

    start: Array
    before: Array
    gates: Gates
    fastest: Array
    curvature: Array


@dataclass(frozen=True, slots=True)
class LocalNodes:
    """States `x` (N+1, 7) in world axes, inputs `u` (N, 3), lengths `T` (N,) [s]."""

    x: Array
    u: Array
    T: Array


@dataclass(frozen=True, slots=True)
class LocalSolution:
    """Where a search ended. `violation`: of the constraints, scaled; `slack` [m, m/s]: largest softness used."""

    nodes: LocalNodes
    solved: bool
    status: int
    iterations: int
    violation: float
    slack: float
    time: float


def tools(solver: ca.Function, motion: ca.Function) -> Tools:
    """The tools for a solver of any horizon."""
    count = solver.numel_in("x0") - STATES - 1
    return Tools(solver, motion, count // (STATES + INPUTS + 2))


def constants(p: Mapping[str, Any]) -> Array:
    """The numbers of the car, with the friction of combined slip."""
    friction = p["tyre.friction"] if p["tyre.combined_slip"] else NO_COMBINED_SLIP
    return np.array([*(p[f"design.{name}"] for name in CAR), friction])


def search(tools: Tools, p: Mapping[str, Any], ahead: Ahead, guess: LocalNodes, *, soft: bool = False) -> LocalSolution:
    """Solve the local problem, with `soft` beyond its corridor and its last speed where need be."""
    lower, upper, g_lower, g_upper = _bounds(p, ahead, soft=soft)
    first = _packed(into_frames(guess.x.T, ahead.gates.frames), guess.u, guess.T)
    weights = [p[f"weight.{name}"] for name in WEIGHTS]
    parameters = np.concatenate([ahead.gates.steps.ravel(), ahead.before, weights, ahead.curvature[-1:], constants(p)])
    begin = perf_counter()
    found = tools.solver(x0=np.clip(first, lower, upper), lbx=lower, ubx=upper, lbg=g_lower, ubg=g_upper, p=parameters)
    seconds = perf_counter() - begin if p["solver.timed"] else 0.0
    stats = tools.solver.stats()
    w, g = found["x"].full().ravel(), found["g"].full().ravel()
    nodes, slack = _unpacked(w, ahead.gates.frames)
    wrong = [0.0, *(g_lower - g), *(g - g_upper), *(lower - w), *(w - upper)]
    status = _STATUS.get(stats["return_status"], -4)
    sane = bool(np.isfinite(w).all() and np.isfinite(g).all())
    return LocalSolution(
        nodes,
        bool(stats["success"]) and sane,
        status,
        int(stats["iter_count"]),
        float(max(wrong)) if sane else 1e9,
        slack if sane else 0.0,
        seconds,
    )


def _bounds(p: Mapping[str, Any], ahead: Ahead, *, soft: bool) -> tuple[Array, Array, Array, Array]:
    """Of the decision variables and of the constraints."""
    gates, N = ahead.gates, len(ahead.fastest) - 1
    most = np.array([0.0, 0.0, 0.0, p["limit.sideslip"], _TURN, np.inf, p["limit.steering_angle"]])
    low, high = np.repeat(-most[:, None], N + 1, axis=1), np.repeat(most[:, None], N + 1, axis=1)
    low[1], high[1], low[2], high[2] = gates.low, gates.high, SLOWEST, np.fmax(ahead.fastest, SLOWEST)
    if not soft:
        low[3, -1], high[3, -1] = max(low[3, -1], -_SIDESLIP), min(high[3, -1], _SIDESLIP)
    low[:, 0] = high[:, 0] = into_frames(ahead.start[:, None], gates.frames[:1])[:, 0]
    rate = p["limit.steering_rate"]
    least = np.array([-rate, -p["limit.front_brake"], -p["limit.rear_brake"]])
    longest = 2 * np.hypot(*gates.steps[:, :2].T) / SLOWEST
    side, fast = (_SOFT_SIDE, p["limit.speed"]) if soft else (0.0, 0.0)
    lower = _column(low, np.tile(least, (N, 1)), np.full(N, _SHORTEST), -side, 0.0)
    upper = _column(high, np.tile([rate, 0.0, p["limit.rear_drive"]], (N, 1)), longest, side, fast)
    end = np.array([_SOFT_COURSE, np.inf] if soft else [_COURSE, _YAW_RATE])
    gaps = np.zeros(STATES * N)
    return lower, upper, np.concatenate([gaps, -end]), np.concatenate([gaps, end])


def _packed(x: Array, u: Array, T: Array) -> Array:
    return _column(x, u, T, 0.0, 0.0)


def _column(x: Array, u: Array, T: Array, side: float, fast: float) -> Array:
    """The decision variables from states (7, N+1) in frames, inputs (N, 3), lengths (N,) and the slacks."""
    scaled = (x / np.array(SCALE)[:, None]).ravel("F"), (u / np.array(INPUT_SCALE)).ravel()
    return np.concatenate([*scaled, T, np.full(len(T), side), [fast]])


def _unpacked(w: Array, frames: Array) -> tuple[LocalNodes, float]:
    """The nodes in world axes, and the largest slack."""
    N = len(frames) - 1
    X, U, T, side, fast = np.split(w, np.cumsum([STATES * (N + 1), INPUTS * N, N, N]))
    x = X.reshape(N + 1, STATES).T * np.array(SCALE)[:, None]
    x[1, 1:] += side
    x[2, -1] += fast[0]
    nodes = LocalNodes(out_of_frames(x, frames).T, U.reshape(N, INPUTS) * np.array(INPUT_SCALE), T)
    return nodes, float(max(np.max(np.abs(side)), fast[0]))
