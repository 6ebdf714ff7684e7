"""Solvers of quadratic programs, all asked alike: a problem to its solution, the seconds inside, and those of the call.

`inside` is what the solver's own clock says, without Python.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import osqp
from scipy import sparse
from scipy.sparse.linalg import splu

from benchmarks.qp_problems import Problem
from fmukit.qp import QpSolver
from fmus.controllers.mpc_allocator.linearise import N_U, N_X

Answer = tuple[np.ndarray, float, float]
Solve = Callable[[Problem], Answer]
_BLOCK = N_U + N_X + 1  # inputs, states and excess of a node of the prediction


def generated(solver: QpSolver) -> Solve:
    """OSQP as the C an FMU holds, called through CasADi."""

    def solve(problem: Problem) -> Answer:
        arguments = problem.arguments(timed=True)
        result, called = _timed(lambda: solver.function.call(arguments))
        return result[0].full().ravel(), float(result[7]), called

    return solve


def package(solver: QpSolver, first: Problem, **changes: float) -> Solve:
    """OSQP's Python package, set up once with the same settings but for `changes`, same starts."""
    own = osqp.OSQP()
    own.setup(first.P, first.q, first.A, first.l, first.u, **solver.settings.osqp() | changes)

    def run(problem: Problem) -> Any:
        own.update(Px=problem.P.data, q=problem.q, Ax=problem.A.data, l=problem.l, u=problem.u)
        own.update_settings(rho=problem.rho or solver.settings.rho)
        own.warm_start(problem.x0, problem.y0)
        return own.solve(raise_error=False)

    def solve(problem: Problem) -> Answer:
        result, called = _timed(lambda: run(problem))
        return np.array(result.x), result.info.update_time + result.info.solve_time, called

    return solve


def daqp(first: Problem) -> Solve:
    """A dense active-set method without a start: bounds alone, or the condensed program (condensing is not counted)."""
    import daqp as own  # noqa: PLC0415 (may be missing)

    form = _dense_bounds if _bounds_alone(first) else condensed

    def solve(problem: Problem) -> Answer:
        H, f, G, low, high, back = form(problem)
        (x, _, _, info), called = _timed(lambda: own.solve(H, f, G, high, low))
        return back(np.array(x)), info["setup_time"] + info["solve_time"], called

    return solve


def piqp(first: Problem) -> Solve:
    """An interior-point method without a start, set up once: dense with bounds alone, else sparse."""
    import piqp as own  # noqa: PLC0415 (may be missing)

    bounded, equal = _bounds_alone(first), _equations(first)
    solver = own.DenseSolver() if bounded else own.SparseSolver()
    solver.settings.compute_timings = True

    def parts(problem: Problem) -> dict[str, Any]:
        if bounded:
            return {"P": np.asfortranarray(problem.full.toarray()), "c": problem.q, "x_l": problem.l, "x_u": problem.u}
        rows = problem.A.tocsr()
        equations, others = (sparse.csc_matrix(rows[chosen]) for chosen in (equal, ~equal))
        limits = {"b": problem.l[equal], "h_l": problem.l[~equal], "h_u": problem.u[~equal]}
        return {"P": problem.full, "c": problem.q, "A": equations, "G": others, **limits}

    def solve(problem: Problem) -> Answer:
        data = parts(problem)
        _, called = _timed(lambda: (solver.update(**data), solver.solve()))
        info = solver.result.info
        return np.array(solver.result.x), info.update_time + info.solve_time, called

    solver.setup(**parts(first))
    return solve


def _timed(call: Callable[[], Any]) -> tuple[Any, float]:
    start = time.perf_counter()
    result = call()
    return result, time.perf_counter() - start


def _bounds_alone(problem: Problem) -> bool:
    m, n = problem.A.shape
    return m == n and (sparse.eye(n) != problem.A).nnz == 0


def _dense_bounds(problem: Problem) -> tuple[Any, ...]:
    n = len(problem.q)
    return problem.full.toarray(), problem.q, np.zeros((0, n)), problem.l, problem.u, lambda x: x


def _states(n: int) -> np.ndarray:
    """Which unknowns are predicted states."""
    place = np.arange(n) % _BLOCK
    return (place >= N_U) & (place < N_U + N_X)


def _equations(problem: Problem) -> np.ndarray:
    """Which rows are those of the prediction: equations between predicted states."""
    touched = np.asarray(abs(problem.A[:, _states(len(problem.q))]).sum(axis=1)).ravel() > 0.0
    return touched & (problem.l == problem.u)


def condensed(problem: Problem) -> tuple[Any, ...]:
    """(H, f, G, low, high) without the predicted states, and the way back to all unknowns."""
    n = len(problem.q)
    states, equal, rows = _states(n), _equations(problem), problem.A.tocsr()
    equations = sparse.csc_matrix(rows[equal])
    factor = splu(sparse.csc_matrix(equations[:, states]))
    T, offset = np.zeros((n, n - states.sum())), np.zeros(n)
    T[~states] = np.eye(T.shape[1])
    T[states] = -factor.solve(equations[:, ~states].toarray())
    offset[states] = factor.solve(problem.l[equal])
    H, f = T.T @ (problem.full @ T), T.T @ (problem.q + problem.full @ offset)
    moved = rows[~equal] @ offset
    return H, f, rows[~equal] @ T, problem.l[~equal] - moved, problem.u[~equal] - moved, lambda r: T @ r + offset
