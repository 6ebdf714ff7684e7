"""One run of IPOPT on a program, with all that says how it went."""

from __future__ import annotations

from dataclasses import dataclass
from time import perf_counter
from typing import Any

import numpy as np

from fmus.planner import compiled
from fmus.planner.errors import SearchError
from fmus.planner.gates import Array
from fmus.planner.program import Nodes, NonlinearProgram


@dataclass(frozen=True, slots=True)
class Multipliers:
    """Of the bounds of the decision variables and of the constraints."""

    bounds: Array
    constraints: Array


@dataclass(frozen=True, slots=True)
class Solution:
    """A solution and what it cost: `build_time`, `solve_time` [s], `how` the derivatives were evaluated.

    `residual`: largest violation of a constraint of the program, in scaled units.
    """

    nodes: Nodes
    status: str
    iterations: int
    build_time: float
    solve_time: float
    how: str
    residual: float
    multipliers: Multipliers


def search(
    program: NonlinearProgram,
    first: Nodes,
    options: dict[str, Any],
    *,
    compile_: bool,
    multipliers: Multipliers | None = None,
) -> Solution:
    """The solution that IPOPT finds from `first` and its `multipliers`; raises SearchError when it finds none."""
    solver = compiled.solver(program, options, compile_=compile_)
    before = perf_counter()
    found = solver.call(
        x0=program.pack(first),
        lbx=program.lower,
        ubx=program.upper,
        lbg=program.g_lower,
        ubg=program.g_upper,
        p=program.parameters,
        **({} if multipliers is None else {"lam_x0": multipliers.bounds, "lam_g0": multipliers.constraints}),
    )
    seconds, stats = perf_counter() - before, solver.call.stats()
    status, iterations = str(stats["return_status"]), int(stats["iter_count"])
    g = found["g"].full().ravel()
    violation = np.maximum(program.g_lower - g, g - program.g_upper)
    if not stats["success"]:
        raise SearchError(status, iterations, _worst_interval(program, violation))
    return Solution(
        nodes=program.unpack(found["x"].full().ravel()),
        status=status,
        iterations=iterations,
        build_time=solver.build_time,
        solve_time=seconds,
        how=solver.how,
        residual=float(max(0.0, violation.max())),
        multipliers=Multipliers(found["lam_x"].full().ravel(), found["lam_g"].full().ravel()),
    )


def ipopt_options(max_iterations: int, tolerance: float, *, warm: bool) -> dict[str, Any]:
    """Options of CasADi's IPOPT; `warm`: the start is a plan already."""
    ipopt: dict[str, Any] = {
        "max_iter": max_iterations,
        "tol": tolerance,
        "mu_strategy": "adaptive",
        "print_level": 0,
        "sb": "yes",
    }
    if warm:
        ipopt |= {"warm_start_init_point": "yes", "mu_init": 1e-2}
    return _quiet(ipopt)


def again_options(max_iterations: int, tolerance: float) -> dict[str, Any]:
    """The same for a search that starts at the solution of nearly the same program, with its multipliers."""
    pushes = ("bound_push", "bound_frac", "slack_bound_push", "slack_bound_frac", "mult_bound_push")
    return _quiet(
        {
            "max_iter": max_iterations,
            "tol": tolerance,
            "mu_strategy": "monotone",
            "mu_init": 1e-4,
            "warm_start_init_point": "yes",
            **{f"warm_start_{name}": 1e-6 for name in pushes},
            "print_level": 0,
            "sb": "yes",
        }
    )


def _quiet(ipopt: dict[str, Any]) -> dict[str, Any]:
    return {"ipopt": ipopt, "print_time": False, "calc_lam_p": False, "error_on_fail": False}


def _worst_interval(program: NonlinearProgram, violation: Array) -> int:
    """Where the motion breaks most: the gaps come first among the constraints, interval by interval."""
    n, m = len(program.vehicle.scale), len(program.origin) - 1
    return int(np.argmax(np.abs(np.nan_to_num(violation[: n * m], nan=np.inf)).reshape(m, n).max(axis=1)))
