"""What the peers of the quadratic programs are given is the same program, and one that is missing is told."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks import qp_peers, qp_solvers
from benchmarks.qp_problems import Problem, recorded
from fmukit.qp import QpSolver
from fmus.controllers.mpc_allocator import COMPONENT


@pytest.fixture(scope="module")
def programs() -> dict[str, tuple[QpSolver, list[Problem]]]:
    kernel = COMPONENT.kernel()
    seen = recorded(COMPONENT, kernel)
    return {solver.name: (solver, seen[solver.name]) for solver in kernel.solvers}


def test_every_sample_is_recorded_and_solved_as_by_the_component(
    programs: dict[str, tuple[QpSolver, list[Problem]]],
) -> None:
    for solver, problems in programs.values():
        assert len(problems) == 200
        x, _, _ = qp_peers.generated(solver)(problems[50])
        exact, _, _ = qp_peers.package(solver, problems[0], eps_abs=1e-9, eps_rel=0.0, max_iter=100_000)(problems[50])
        assert abs(problems[50].cost(x) - problems[50].cost(exact)) < 1e-2 * (1.0 + abs(problems[50].cost(exact)))
        assert problems[50].violation(exact) < 1e-8


def test_the_condensed_program_is_the_same_one(programs: dict[str, tuple[QpSolver, list[Problem]]]) -> None:
    _, problems = programs["tracking"]
    problem, rng = problems[30], np.random.default_rng(0)
    H, f, G, low, high, back = qp_peers.condensed(problem)
    one, other = rng.normal(size=(2, len(f)))
    predicted = problem.A @ back(one)
    equations = qp_peers._equations(problem)
    assert equations.sum() == 7 * 25
    np.testing.assert_allclose(predicted[equations], problem.l[equations], atol=1e-9)
    np.testing.assert_allclose(predicted[~equations] - problem.l[~equations], G @ one - low, atol=1e-9)
    np.testing.assert_allclose(problem.u[~equations] - predicted[~equations], high - G @ one, atol=1e-9)
    gain = problem.cost(back(one)) - problem.cost(back(other))
    assert gain == pytest.approx((one @ H @ one - other @ H @ other) / 2 + f @ (one - other), rel=1e-9)


def test_a_missing_peer_is_told(
    programs: dict[str, tuple[QpSolver, list[Problem]]], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(qp_solvers, "find_spec", lambda name: None)
    solver, problems = programs["wheels"]
    found = qp_solvers._compare(solver, problems[:2], 1)
    assert found["DAQP"] == "not installed: pip install daqp"
    assert found["PIQP"] == "not installed: pip install piqp"
    assert isinstance(found["OSQP, generated C"], qp_solvers.Seen)


@pytest.mark.parametrize("peer", ["daqp", "piqp"])
def test_peers_find_the_optimum(programs: dict[str, tuple[QpSolver, list[Problem]]], peer: str) -> None:
    pytest.importorskip(peer, reason="needs the extra bench")
    for solver, problems in programs.values():
        exact = qp_peers.package(solver, problems[0], eps_abs=1e-9, eps_rel=0.0, max_iter=100_000)
        solve = getattr(qp_peers, peer)(problems[0])
        for problem in problems[::50]:
            x, best = solve(problem)[0], exact(problem)[0]
            assert problem.violation(x) < 1e-4
            assert problem.cost(x) <= problem.cost(best) + 1e-4 * (1.0 + abs(problem.cost(best)))
