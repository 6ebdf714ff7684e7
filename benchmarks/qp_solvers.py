"""The two quadratic programs of MpcAllocator, as they come up in its reference run, by several solvers.

Solvers take their turns one after the other, so that they are compared by the best round of each problem.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from importlib.util import find_spec

import numpy as np

from benchmarks import qp_peers
from benchmarks.qp_peers import Solve
from benchmarks.qp_problems import Problem, recorded
from benchmarks.spread import Spread, microseconds, spread
from fmukit.qp import QpSolver
from fmus.controllers.mpc_allocator import COMPONENT

ROUNDS = 5
_EVERY = 4  # of the samples of the run
_OWN, _INTERPRETED = "OSQP, generated C", "OSQP, Python package"
_SHOWN = {
    "wheels": ("force distribution, 4 variables", "<= 20 us"),
    "tracking": ("prediction, 275 variables", "<= 1000 us, worst 5000"),
}


@dataclass(frozen=True, slots=True)
class Seen:
    """Microseconds over all problems, inside the solver and of the call from Python.

    `error`: the largest excess of a row over its bounds or relative loss of cost, against a solution to 1e-9.
    """

    inside: Spread
    call: Spread
    error: float


def measure(rounds: int = ROUNDS) -> dict[str, dict[str, Seen | str]]:
    """By program and solver; or why there is nothing."""
    kernel = COMPONENT.kernel()
    problems = recorded(COMPONENT, kernel)
    return {solver.name: _compare(solver, problems[solver.name][::_EVERY], rounds) for solver in kernel.solvers}


def rows(rounds: int | None) -> Iterator[tuple[str, str, str, str]]:
    """What `python -m benchmarks` prints: microseconds of the generated C, and the others as multiples of it."""
    rounds = rounds or ROUNDS
    for program, seen in measure(rounds).items():
        title, aim = _SHOWN[program]
        own = seen[_OWN]
        assert isinstance(own, Seen)
        against = f"{microseconds(own.inside, rounds)}; error {own.error:.0e}"
        yield f"{title}: generated C", f"{own.inside.mean:.1f} us", against, aim
        for name, other in seen.items():
            if name != _OWN:
                yield from _beside(name, own.inside, other)


def _beside(name: str, own: Spread, other: Seen | str) -> Iterator[tuple[str, str, str, str]]:
    """Another solver as a multiple of ours, the best rounds of both."""
    if isinstance(other, str):
        yield f"  {name}", "-", other, ""
        return
    best, called = other.inside.best_mean, other.call.best_mean
    against = f"times that: {best:.1f} us, worst {other.inside.best_worst:.1f}, best rounds; error {other.error:.0e}"
    yield f"  {name}", f"{best / own.best_mean:.2f}", against, ""
    if name == _INTERPRETED:
        against = f"times that: {called:.1f} us with the call from Python, best rounds"
        yield "  interpreted against compiled", f"{called / own.best_mean:.2f}", against, ""


def _compare(solver: QpSolver, problems: Sequence[Problem], rounds: int) -> dict[str, Seen | str]:
    exact = qp_peers.package(solver, problems[0], eps_abs=1e-9, eps_rel=0.0, max_iter=100_000)
    best = [exact(problem)[0] for problem in problems]
    found: dict[str, Seen | str] = {}
    for name, make in _makers(solver, problems[0]).items():
        found[name] = make if isinstance(make, str) else _seen(make(), problems, best, rounds)
    return found


def _makers(solver: QpSolver, first: Problem) -> dict[str, Callable[[], Solve] | str]:
    """What makes each solver, or why it is missing."""
    makers: dict[str, Callable[[], Solve] | str] = {
        _OWN: partial(qp_peers.generated, solver),
        _INTERPRETED: partial(qp_peers.package, solver, first),
    }
    for name, make in {"daqp": qp_peers.daqp, "piqp": qp_peers.piqp}.items():
        there = find_spec(name) is not None
        makers[name.upper()] = partial(make, first) if there else f"not installed: pip install {name}"
    return makers


def _seen(solve: Solve, problems: Sequence[Problem], best: Sequence[np.ndarray], rounds: int) -> Seen:
    inside, call, error = np.empty((rounds, len(problems))), np.empty((rounds, len(problems))), 0.0
    for i in range(rounds):
        for j, (problem, exact) in enumerate(zip(problems, best, strict=True)):
            x, inside[i, j], call[i, j] = solve(problem)
            loss = (problem.cost(x) - problem.cost(exact)) / (1.0 + abs(problem.cost(exact)))
            error = max(error, problem.violation(x), loss)
    return Seen(spread(1e6 * inside), spread(1e6 * call), error)


if __name__ == "__main__":
    for row in rows(None):
        print("  |  ".join(row))
