"""Quadratic programs solved by the generated C: optima found by other means, and what is returned without one."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from demo_programs import plan_problem, spread_problem
from scipy import sparse
from scipy.optimize import linprog, lsq_linear

from fmukit import store
from fmukit.errors import BuildError
from fmukit.qp import QpSettings, QpSolver, codegen, library, qp_solver

EXACT = QpSettings(absolute=1e-9, relative=0.0, iterations=20000)
Problem = tuple[sparse.csc_matrix, np.ndarray, sparse.csc_matrix, np.ndarray, np.ndarray]


def _pattern(matrix: sparse.csc_matrix) -> ca.Sparsity:
    return ca.Sparsity(*matrix.shape, matrix.indptr.tolist(), matrix.indices.tolist())


def _known(seed: int, n: int = 12, m: int = 20) -> tuple[Problem, np.ndarray, np.ndarray]:
    """A problem made around its optimum: x*, y* are drawn, q and the bounds follow from the KKT conditions."""
    rng = np.random.default_rng(seed)
    root = sparse.csc_matrix(sparse.random(n, n, 0.3, random_state=1) + sparse.eye(n))
    A = sparse.csc_matrix(sparse.random(m, n, 0.4, random_state=2) + sparse.eye(m, n))
    for matrix in (root, A):
        matrix.data = rng.normal(size=matrix.nnz)
    P = sparse.csc_matrix(root.T @ root + 0.1 * sparse.eye(n))
    x, y = rng.normal(size=n), rng.normal(size=m) * (rng.random(m) < n / m / 2)
    slack, z = rng.uniform(0.1, 2.0, (2, m)), A @ x
    low, high = z - slack[0] * (y >= 0), z + slack[1] * (y <= 0)
    high[::7], low[1::7] = np.where(y[::7] > 0, high[::7], np.inf), np.where(y[1::7] < 0, low[1::7], -np.inf)
    return (sparse.triu(P, format="csc"), -(P @ x + A.T @ y), A, low, high), x, y


def _solve(
    solver: QpSolver, problem: Problem, x0: object = 0.0, y0: object = 0.0, rho: float = 0.0
) -> dict[str, ca.DM]:
    P, q, A, low, high = problem
    arguments = (P.data, q, A.data, low, high, x0, y0, rho, 0)
    names = solver.function.name_out()
    return dict(zip(names, solver.function.call([ca.DM(value) for value in arguments]), strict=True))


def _column(value: ca.DM) -> np.ndarray:
    return value.full().ravel()


def _same(one: dict[str, ca.DM], other: dict[str, ca.DM]) -> bool:
    return all(np.array_equal(one[name].full(), other[name].full()) for name in one)


@pytest.fixture(scope="module")
def small() -> QpSolver:
    """Two variables; P and A full."""
    return qp_solver("test_small", ca.Sparsity.upper(2), ca.Sparsity.dense(2, 2), EXACT)


def _two(**changes: object) -> Problem:
    """min (x0^2 + x1^2)/2 - x0 - 2 x1 with |x0 + x1| <= 1, |x0 - x1| <= 3: optimum (0, 1), multipliers (1, 0)."""
    values = {"P": [1.0, 0.0, 1.0], "q": [-1.0, -2.0], "A": [1.0, 1.0, 1.0, -1.0], "l": [-1.0, -3.0], "u": [1.0, 3.0]}
    values |= changes
    P = sparse.csc_matrix((np.array(values["P"], float), [0, 0, 1], [0, 1, 3]), shape=(2, 2))
    A = sparse.csc_matrix((np.array(values["A"], float), [0, 1, 0, 1], [0, 2, 4]), shape=(2, 2))
    q, low, high = (np.array(values[name], float) for name in ("q", "l", "u"))
    return P, q, A, low, high


def test_two_variables_have_the_optimum_found_by_hand(small: QpSolver) -> None:
    found = _solve(small, _two())
    assert float(found["status"]) == 1
    np.testing.assert_allclose(_column(found["x"]), [0.0, 1.0], atol=1e-7)
    np.testing.assert_allclose(_column(found["y"]), [1.0, 0.0], atol=1e-7)
    assert float(found["time"]) == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_problems_made_around_an_optimum(seed: int) -> None:
    problem, x, y = _known(seed)
    solver = qp_solver("test_known", _pattern(problem[0]), _pattern(problem[2]), EXACT)
    found = _solve(solver, problem)
    assert float(found["status"]) == 1
    np.testing.assert_allclose(_column(found["x"]), x, atol=1e-6)
    np.testing.assert_allclose(_column(found["y"]), y, atol=1e-5)
    P, q, A, low, high = problem
    full, z = P + sparse.triu(P, 1).T, A @ _column(found["x"])
    assert np.abs(full @ _column(found["x"]) + q + A.T @ _column(found["y"])).max() < 1e-8
    assert np.maximum(low - z, z - high).max() < 1e-8


def test_least_squares_in_a_box_agree_with_scipy() -> None:
    limit, spread = 1.0, ca.Sparsity.upper(4)
    solver = qp_solver(
        "test_box", spread, ca.Sparsity.diag(4), QpSettings(absolute=1e-8, relative=0.0, iterations=9999)
    )
    for total in np.linspace(-6.0, 6.0, 9):
        P, q, A, low, high = (ca.DM(value) for value in spread_problem(total, limit))
        upper = sparse.csc_matrix(P.full())
        root = np.linalg.cholesky((upper + sparse.triu(upper, 1).T).toarray())
        best = lsq_linear(root.T, -np.linalg.solve(root, _column(q)), (-limit, limit), method="bvls", tol=1e-14)
        found = _solve(solver, (upper, _column(q), sparse.csc_matrix(A.full()), _column(low), _column(high)))
        np.testing.assert_allclose(_column(found["x"]), best.x, atol=1e-6)


def test_a_linear_programme_agrees_with_scipy() -> None:
    """P without its diagonal: the regularisation alone makes the matrix definite."""
    rng = np.random.default_rng(5)
    A, x = rng.normal(size=(8, 3)), rng.normal(size=3)
    q, high = A.T @ rng.random(8), A @ x + rng.random(8)
    P = sparse.csc_matrix(([0.0], [0], [0, 0, 1, 1]), shape=(3, 3))
    solver = qp_solver("test_linear", _pattern(P), ca.Sparsity.dense(8, 3), EXACT)
    found = _solve(solver, (P, -q, sparse.csc_matrix(A), np.full(8, -np.inf), high))
    best = linprog(-q, A_ub=A, b_ub=high, bounds=(None, None))
    assert float(found["status"]) == 1
    np.testing.assert_allclose(_column(found["x"]), best.x, atol=1e-6)


USELESS = {
    "NaN in q": ({"q": [np.nan, 0.0]}, -1),
    "infinity in A": ({"A": [np.inf, 0.0, 0.0, 1.0]}, -1),
    "NaN in P": ({"P": [1.0, np.nan, 1.0]}, -1),
    "NaN bound": ({"u": [np.nan, 1.0]}, -1),
    "crossed bounds": ({"l": [2.0, 0.0]}, -2),
    "not convex": ({"P": [-10.0, 0.0, 1.0]}, -3),
    "overflow": ({"q": [1e300, -1e300], "P": [1e-300, 0.0, 1e-300], "l": [-1e30, -1e30], "u": [1e30, 1e30]}, None),
    "primal infeasible": ({"A": [1.0, 1.0, 1.0, 1.0], "l": [-1.0, 2.0]}, 3),
    "dual infeasible": ({"P": [0.0, 0.0, 0.0], "l": [-1.0, -1.0], "u": [np.inf, 1.0]}, 5),
}


@pytest.mark.parametrize("name", USELESS)
def test_without_a_solution_the_start_is_returned_and_nothing_stays_behind(small: QpSolver, name: str) -> None:
    changes, status = USELESS[name]
    before = _solve(small, _two(), [0.3, 0.1], [0.2, -0.1], 0.7)
    found = _solve(small, _two(**changes), [0.25, -0.5], [1.0, 2.0], 0.7)
    assert all(np.isfinite(value.full()).all() for value in found.values())
    if status is None:
        assert float(found["status"]) != 1
    else:
        assert float(found["status"]) == status
    np.testing.assert_array_equal(_column(found["x"]), [0.25, -0.5])
    np.testing.assert_array_equal(_column(found["y"]), [1.0, 2.0])
    assert float(found["rho"]) == EXACT.rho
    assert _same(_solve(small, _two(), [0.3, 0.1], [0.2, -0.1], 0.7), before)


def test_a_start_that_is_not_finite_is_never_given_back(small: QpSolver) -> None:
    found = _solve(small, _two(), [np.nan, 0.5], [np.inf, 1.0])
    assert float(found["status"]) == -1
    np.testing.assert_array_equal(_column(found["x"]), [0.0, 0.5])
    np.testing.assert_array_equal(_column(found["y"]), [0.0, 1.0])


def test_whatever_the_numbers_results_are_finite_and_leave_no_trace(small: QpSolver) -> None:
    rng = np.random.default_rng(11)
    strange = [0.0, 1.0, -1.0, 1e300, -1e300, 1e-300, 1e30, 1e31, 5e-324, 1e8, -1e8, np.nan, np.inf, -np.inf]
    before = _solve(small, _two(), [0.3, 0.1], [0.2, -0.1], 0.7)
    seen = set()
    for _ in range(1500):
        arguments = [rng.normal(size=small.function.size1_in(i)) for i in range(8)]
        for argument in arguments:
            chosen = rng.random(len(argument)) < 0.15
            argument[chosen] = rng.choice(strange, chosen.sum())
        found = small.function.call([ca.DM(argument) for argument in (*arguments, 0)])
        assert all(np.isfinite(value.full()).all() for value in found)
        seen.add(int(found[3]))
    assert seen >= {1, -1, -2, -3, -4}
    assert _same(_solve(small, _two(), [0.3, 0.1], [0.2, -0.1], 0.7), before)


def test_too_few_iterations_are_told() -> None:
    solver = qp_solver(
        "test_few",
        ca.Sparsity.upper(2),
        ca.Sparsity.dense(2, 2),
        QpSettings(absolute=1e-12, relative=0.0, iterations=3),
    )
    found = _solve(solver, _two())
    assert (float(found["status"]), float(found["iterations"])) == (7, 3)
    assert np.abs(_column(found["x"]) - [0.0, 1.0]).max() < 1.0


def _sequence(count: int) -> list[Problem]:
    """The plan of a point that is pushed about: the same pattern, other numbers and active bounds every time."""
    rng = np.random.default_rng(2)
    made = []
    for _ in range(count):
        parts = plan_problem(ca.DM(rng.normal(size=2)), float(rng.normal()), float(rng.uniform(0.2, 2.0)), 0.0)
        P, q, A, low, high = (ca.DM(part) for part in parts)
        matrices = (
            sparse.csc_matrix((_column(M.nz[:]), M.row(), M.sparsity().colind()), shape=M.shape) for M in (P, A)
        )
        upper, rows = matrices
        upper.data *= rng.uniform(0.5, 2.0)
        made.append((upper, _column(q), rows, _column(low), _column(high)))
    return made


def _chain(
    solver: QpSolver, problems: list[Problem], between: Callable[[], object] = lambda: None
) -> list[dict[str, ca.DM]]:
    """Each from the solution and penalty of the one before."""
    found = [_solve(solver, problems[0])]
    for problem in problems[1:]:
        between()
        last = found[-1]
        found.append(_solve(solver, problem, last["x"], last["y"], float(last["rho"])))
    return found


@pytest.fixture(scope="module")
def plan() -> QpSolver:
    problem = _sequence(1)[0]
    return qp_solver("test_plan", _pattern(problem[0]), _pattern(problem[2]), QpSettings(absolute=1e-6, relative=0.0))


def test_two_callers_in_turn_equal_each_alone(plan: QpSolver) -> None:
    problems = _sequence(30)
    one, other = problems[:15], problems[15:]
    alone = _chain(plan, one)
    spoiled = (np.full_like(other[0][1], np.nan), *other[0][2:])
    others = iter([*other, (other[0][0], *spoiled)])
    together = _chain(plan, one, between=lambda: _solve(plan, next(others)))
    assert all(_same(a, b) for a, b in zip(alone, together, strict=True))
    assert len({float(found["rho"]) for found in alone}) > 2
    assert {float(found["status"]) for found in alone} == {1.0}


def test_the_order_of_problems_does_not_matter(plan: QpSolver) -> None:
    problems = _sequence(12)
    forward = [_solve(plan, problem) for problem in problems]
    backward = [_solve(plan, problem) for problem in reversed(problems)]
    assert all(_same(a, b) for a, b in zip(forward, reversed(backward), strict=True))


def test_threads_do_not_disturb_each_other(plan: QpSolver) -> None:
    """CasADi lets other threads run while it evaluates."""
    problems = _sequence(40)
    halves = [problems[:20], problems[20:]]
    alone = [_chain(plan, half) for half in halves]
    found: list[list[dict[str, ca.DM]]] = [[], []]

    def run(which: int) -> None:
        for _ in range(3):
            found[which] = _chain(plan, halves[which])

    threads = [threading.Thread(target=run, args=(which,)) for which in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for expected, seen in zip(alone, found, strict=True):
        assert all(_same(a, b) for a, b in zip(expected, seen, strict=True))


def test_a_warm_start_saves_iterations(plan: QpSolver) -> None:
    problem = _sequence(1)[0]
    cold = _solve(plan, problem)
    warm = _solve(plan, problem, cold["x"], cold["y"], float(cold["rho"]))
    assert float(warm["iterations"]) <= 20 < float(cold["iterations"])


def test_time_is_given_when_asked_for(plan: QpSolver) -> None:
    P, q, A, low, high = _sequence(1)[0]
    found = plan.function(P.data, q, A.data, low, high, 0, 0, 0, 1)
    assert 0.0 < float(found[7]) < 1.0


def test_a_damaged_library_is_compiled_anew_and_a_sound_one_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(store, "cache_folder", lambda: tmp_path)
    patterns = ca.Sparsity.upper(2), ca.Sparsity.dense(2, 2)
    texts, units = codegen.sources("qp_kept", *patterns, EXACT), (codegen.COMMON, "qp_kept.c")
    path = library.compiled("qp_kept", texts, units)
    whole, made = path.read_bytes(), path.stat().st_mtime_ns
    assert library.compiled("qp_kept", texts, units).stat().st_mtime_ns == made
    path.write_bytes(whole[:1000])
    assert library.compiled("qp_kept", texts, units).read_bytes() == whole


def test_a_cache_that_cannot_be_written_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "file").write_text("in the way")
    monkeypatch.setattr(store, "cache_folder", lambda: tmp_path / "file")
    with pytest.raises(BuildError, match=r"the cache folder .* cannot be written"):
        qp_solver("test_nowhere", ca.Sparsity.upper(2), ca.Sparsity.diag(2))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"rho": 0.0}, "rho is 0"),
        ({"absolute": float("nan")}, "absolute is nan"),
        ({"alpha": 2.0}, "alpha is 2.0"),
        ({"absolute": 0.0, "relative": 0.0}, "absolute and relative are both 0"),
        ({"check": 10, "adapt": 15}, "adapt is 15, not a multiple of check = 10"),
        ({"iterations": -1}, "iterations is -1"),
    ],
)
def test_settings_that_make_no_sense_are_refused(changes: dict[str, float], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        QpSettings(**changes)


@pytest.mark.parametrize(
    ("name", "P", "A", "said"),
    [
        ("Bad Name", ca.Sparsity.upper(2), ca.Sparsity.diag(2), "the name 'Bad Name'"),
        ("a", ca.Sparsity.lower(2), ca.Sparsity.diag(2), "upper triangle"),
        ("a", ca.Sparsity.dense(2, 3), ca.Sparsity.diag(3), "upper triangle"),
        ("a", ca.Sparsity.upper(2), ca.Sparsity.diag(3), "A has 3 columns, P has 2"),
        ("a", ca.Sparsity(2, 2), ca.Sparsity.diag(2), "at least one nonzero"),
    ],
)
def test_patterns_that_do_not_fit_are_refused(name: str, P: ca.Sparsity, A: ca.Sparsity, said: str) -> None:
    with pytest.raises(ValueError, match=said):
        qp_solver(name, P, A)
