"""Time-optimal plans of the double lane change: compiled against interpreted derivatives and against plain CasADi.

The peer is the same problem as a user of CasADi would write it, with `Opti` and the derivatives CasADi finds itself.
Fatrop, an interior-point solver made for such programs, meets IPOPT in the time that each takes for itself, without
the derivatives, which both call alike.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median
from time import perf_counter, process_time
from typing import Any

import casadi as ca
import numpy as np

from fmus.planner import compiled, gate_grid, guess, time_grid
from fmus.planner.gates import Array
from fmus.planner.hocp import Grid, Settings
from fmus.planner.program import Nodes, Program, standing_ends, state_bounds
from fmus.planner.road import double_lane_change
from fmus.planner.search import ipopt_options
from fmus.planner.shooting import interval
from fmus.planner.vehicle import two_wheel_drive
from fmus.single_track.data import car

ROUNDS = 7
AIMS: dict[tuple[Grid, int], float] = {("gate", 80): 0.10, ("gate", 160): 0.30, ("time", 80): 0.40}
"""Most that a plan may take after compilation [s]."""

_ROAD, _CAR, _ENDS, _HOW = double_lane_change(), two_wheel_drive(car()), standing_ends(), Settings()
_EVERYWHERE = (-np.inf, np.inf)
_LENGTHS = (1e-3, 2.0)
_INPUT_BOUNDS = (_CAR.input_lower / _CAR.input_scale, _CAR.input_upper / _CAR.input_scale)


@dataclass(frozen=True, slots=True)
class Timed:
    """Of several rounds: `seconds` median of the wall time, `least` processor time, `own` the solver's share of it.

    `final_time` [s] of the plan.
    """

    seconds: float
    least: float
    own: float
    iterations: int
    final_time: float


@dataclass(frozen=True, slots=True)
class Figures:
    """Of one mesh: our plan `compiled` and `interpreted`; `opti` and `fatrop` on the gate grid only."""

    compiled: Timed
    interpreted: Timed
    opti: Timed | None = None
    fatrop: Timed | None = None


def measure(grid: Grid, m: int, rounds: int = ROUNDS, *, peers: bool = False) -> Figures:
    """Plan `rounds` times compiled and at most twice in every slower way; all must find the same end time."""
    program, first = _program(grid, m)
    few = min(rounds, 2)
    figures = Figures(
        _timed(_planner(program, first, compile_=True), rounds),
        _timed(_planner(program, first, compile_=False), few),
        _timed(_opti(m, first), few) if peers else None,
        _timed(_fatrop(m, first), few) if peers else None,
    )
    for peer in (figures.interpreted, figures.opti, figures.fatrop):
        if peer is not None and abs(peer.final_time - figures.compiled.final_time) > 1e-4:
            raise RuntimeError(f"the end times differ: {peer.final_time} and {figures.compiled.final_time} s")
    return figures


Run = Callable[[], tuple[dict[str, Any], float]]
"""A solution: the solver's statistics and the end time [s]."""


def _timed(run: Run, rounds: int) -> Timed:
    wall, processor = [], []
    for _ in range(rounds):
        start = perf_counter(), process_time()
        stats, final_time = run()
        wall.append(perf_counter() - start[0])
        processor.append(process_time() - start[1])
    inside = sum(value for name, value in stats.items() if name.startswith("t_proc_nlp"))
    return Timed(median(wall), min(processor), processor[-1] - inside, int(stats["iter_count"]), final_time)


def _program(grid: Grid, m: int) -> tuple[Program, Nodes]:
    """Our program and where the search begins."""
    gates = _ROAD.gates(m)
    first = guess.along_gates(_CAR, gates, _ENDS)
    if grid == "gate":
        return gate_grid.program(_CAR, gates, _ENDS, substeps=_HOW.substeps, smoothing=_HOW.smoothing), first
    program = time_grid.program(_CAR, _ROAD, m, _ENDS, substeps=_HOW.substeps, smoothing=_HOW.smoothing)
    return program, guess.on_equal_times(first)


def _planner(program: Program, first: Nodes, *, compile_: bool) -> Run:
    options = ipopt_options(_HOW.max_iterations, _HOW.tolerance, warm=False)
    solver = compiled.solver(program, options, compile_=compile_)
    if compile_ and solver.how != "compiled":
        raise RuntimeError(f"the derivatives are {solver.how}")
    bounds = {"lbx": program.lower, "ubx": program.upper, "lbg": program.g_lower, "ubg": program.g_upper}

    def run() -> tuple[dict[str, Any], float]:
        found = solver.call(x0=program.pack(first), p=program.parameters, **bounds)
        return solver.call.stats(), float(program.unpack(found["x"].full().ravel()).times[-1])

    return run


def _opti(m: int, first: Nodes) -> Run:
    """The gate grid, one constraint after the other."""
    opti, step = ca.Opti(), _step()
    X, U, T = opti.variable(7, m + 1), opti.variable(3, m), opti.variable(m)
    opti.minimize(ca.sum1(T) + _HOW.smoothing * ca.sumsqr(U[:, 1:] - U[:, :-1]))
    low, high = _bounds(m)
    for k in range(m):
        opti.subject_to(step(X[:, k], U[:, k], T[k]) == X[:, k + 1])
        opti.subject_to(opti.bounded(_INPUT_BOUNDS[0], U[:, k], _INPUT_BOUNDS[1]))
        opti.subject_to(opti.bounded(_LENGTHS[0], T[k], _LENGTHS[1]))
    for i, k in np.argwhere(np.isfinite(low)).tolist():
        opti.subject_to(opti.bounded(low[i, k], X[i, k], high[i, k]))
    for variable, value in zip((X, U, T), _start(first), strict=True):
        opti.set_initial(variable, value)
    opti.solver("ipopt", {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "tol": _HOW.tolerance}})

    def run() -> tuple[dict[str, Any], float]:
        found = opti.solve()
        return found.stats(), float(np.sum(found.value(T)))

    return run


def _fatrop(m: int, first: Nodes) -> Run:
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
    cost = sum(one[3] for one in u[:m]) + _HOW.smoothing * changes
    stages = [part for pair in zip(x, u, strict=True) for part in pair][:-1]
    nlp = {"x": ca.veccat(*stages), "f": cost, "g": g}
    options = {"structure_detection": "auto", "equality": [True] * g.numel(), "print_time": False}
    solver = ca.nlpsol("plan", "fatrop", nlp, options | {"fatrop": {"print_level": 0, "tol": _HOW.tolerance}})
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
    end = interval(_CAR.f, _HOW.substeps)(_CAR.scale * X, _CAR.input_scale * U, T)
    return ca.Function("step", [X, U, T], [end / _CAR.scale])


def _bounds(m: int) -> tuple[Array, Array]:
    """Of the scaled states (7, m+1) in the world, positions on their gates."""
    gates = _ROAD.gates(m)
    low, high = state_bounds(_CAR, gates, _ENDS)
    low[0] = high[0] = gates.frames[:, 0]
    low[1], high[1] = gates.low, gates.high
    return low / _CAR.scale[:, None], high / _CAR.scale[:, None]


def _start(first: Nodes) -> tuple[Array, Array, Array]:
    return first.x / _CAR.scale[:, None], first.u / _CAR.input_scale[:, None], first.T
