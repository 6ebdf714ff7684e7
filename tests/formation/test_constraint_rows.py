"""The library of constraints against finite differences, numpy's least squares and pseudo-inverse."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve

from fmus.controllers.constraint_follower import constraints, law
from tests.references import joint_rows

STEP = 1e-5
CHAIN = ((1, 0), (2, 1), (3, 2))
SIZES = {"joint": (12, 6, 0), "follower": (3, 9, 1)}


def _rows(kind: str) -> ca.Function:
    return joint_rows.formation(CHAIN, 4) if kind == "joint" else law.follower_rows()


class Motion:
    """Smooth random motions q(t), s(t) with known derivatives; `fixed` never moves."""

    def __init__(self, kind: str, seed: int) -> None:
        random, (n, m, fixed) = np.random.default_rng(seed), SIZES[kind]
        self.rows, self.n, self.fixed = _rows(kind), n, np.full(fixed, 6.0)
        self.a, self.w, self.f = (random.uniform(0.3, 1.5, n + m) for _ in range(3))
        self.b = random.uniform(-8.0, 8.0, n + m)

    def at(self, t: float, order: int = 0) -> tuple[np.ndarray, np.ndarray]:
        phase = self.w * t + self.f + order * np.pi / 2
        z = self.a * self.w**order * np.sin(phase) + (self.b if order == 0 else 0.0)
        return z[: self.n], z[self.n :]

    def evaluate(self, t: float) -> list[np.ndarray]:
        (q, s), (dq, ds), (_, dds) = (self.at(t, order) for order in range(3))
        return [np.array(part) for part in self.rows(q, dq, s, ds, dds, self.fixed)]


@pytest.mark.parametrize("kind", SIZES)
@pytest.mark.parametrize("seed", range(3))
def test_jacobian_and_rates_are_those_of_finite_differences(kind: str, seed: int) -> None:
    motion = Motion(kind, seed)
    _, W, rate, gamma = motion.evaluate(0.0)
    before, after = motion.evaluate(-STEP), motion.evaluate(STEP)
    assert rate == pytest.approx((after[0] - before[0]) / (2 * STEP), abs=1e-6)
    q_acceleration = motion.at(0.0, 2)[0]
    assert W @ q_acceleration[:, None] + gamma == pytest.approx((after[2] - before[2]) / (2 * STEP), abs=1e-6)
    (q, s), zeros = motion.at(0.0), [np.zeros(n) for n in (*SIZES[kind][:2], SIZES[kind][1])]
    for k in range(motion.n):
        step = STEP * np.eye(motion.n)[k]
        moved = [np.array(motion.rows(q + d, zeros[0], s, *zeros[1:], motion.fixed)[0]) for d in (step, -step)]
        assert W[:, [k]] == pytest.approx((moved[0] - moved[1]) / (2 * STEP), abs=1e-7)


@pytest.mark.parametrize("seed", range(3))
def test_turning_of_the_jacobian_is_in_gamma(seed: int) -> None:
    """At a place that is driven but stands still, gamma is W' q' alone."""
    motion = Motion("joint", seed)
    (q, s), (dq, _), rest = motion.at(0.0), motion.at(0.0, 1), np.zeros(6)
    W = [np.array(motion.rows(q + d * STEP * dq, dq, s, rest, rest, [])[1]) for d in (1, -1)]
    gamma = np.array(motion.rows(q, dq, s, rest, rest, [])[3])
    assert np.abs(gamma).max() > 0.1
    assert gamma == pytest.approx((W[0] - W[1]) / (2 * STEP) @ dq[:, None], abs=1e-7)


def test_rows_of_a_follower_are_a_block_of_the_joint_rows() -> None:
    random, a = np.random.default_rng(5), 6.0
    lead, lead_rate = random.uniform(-1, 1, 3), random.uniform(-1, 1, 3)
    own, own_rate, r = random.uniform(-1, 1, 3), random.uniform(-1, 1, 3), np.array([-8.0, 4.0])
    yaw, turn = lead[2], lead_rate[2]
    e, across = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    hand, hand_rate = lead[:2] + a * e, lead_rate[:2] + a * turn * across
    joint = joint_rows.formation(((1, 0),), 2)
    q, dq = np.concatenate([hand, [yaw], own]), np.concatenate([hand_rate, [turn], own_rate])
    value, W, rate, gamma = (np.array(part) for part in joint(q, dq, r, [0, 0], [0, 0], []))
    hand_acceleration = -a * turn**2 * e
    nothing, s = np.zeros(3), np.concatenate([lead, r, np.zeros(3), [yaw]])
    driven = np.concatenate([lead_rate, np.zeros(5), [turn]])
    seen = law.follower_rows()(own, own_rate, s, driven, np.zeros(9), a)
    value_own, W_own, rate_own, gamma_own = (np.array(part)[:2] for part in seen)
    assert value == pytest.approx(value_own, abs=1e-12)
    assert rate == pytest.approx(rate_own, abs=1e-12)
    assert W[:, 3:] == pytest.approx(W_own, abs=1e-12)
    from_the_leader = W[:, :3] @ np.concatenate([hand_acceleration, [0.0]])[:, None]
    assert gamma + from_the_leader == pytest.approx(gamma_own, abs=1e-12)
    kept = np.array(ca.DM(ca.evalf(joint_rows.isolated(ca.SX(W), ((1, 0),)))))
    assert kept[:, :3].tolist() == [nothing.tolist()] * 2
    assert kept[:, 3:].tolist() == W[:, 3:].tolist()


def _multipliers(G: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    found = constraints.multipliers(ca.SX(ca.DM(G)), ca.SX(ca.DM(b)))
    value, residual = (np.array(ca.DM(ca.evalf(part))).ravel() for part in found)
    return value, residual


def _rank(G: np.ndarray) -> float:
    return float(ca.evalf(constraints.rank(ca.SX(ca.DM(G)))))


@pytest.mark.parametrize("rows", [1, 2, 6, 8])
def test_factorisation_solves_what_scipy_solves(rows: int) -> None:
    random = np.random.default_rng(rows)
    B = random.normal(size=(rows, rows))
    A, b = B @ B.T + 0.1 * np.eye(rows), random.normal(size=rows)
    x = np.array(ca.DM(ca.evalf(constraints.solve(ca.SX(ca.DM(A)), ca.SX(b))))).ravel()
    assert x == pytest.approx(cho_solve(cho_factor(A), b), rel=1e-9)


def test_independent_rows_get_exactly_what_they_ask() -> None:
    random = np.random.default_rng(1)
    G, b = np.array([[0.8, 0.6], [-0.6, 0.8]]), random.normal(size=2)
    value, residual = _multipliers(G, b)
    assert value == pytest.approx(np.linalg.solve(G @ G.T, b), rel=2e-6)
    assert G @ (-G.T @ value) == pytest.approx(-b, rel=2e-6)
    assert np.abs(residual).max() < 2e-6 * np.abs(b).max()
    assert _rank(G) == 2.0


def test_redundant_rows_change_nothing() -> None:
    """Rows named twice move the vehicle as once, and numpy's minimum-norm multipliers share the load alike."""
    random = np.random.default_rng(2)
    G, b = random.normal(size=(2, 2)) / 2, random.normal(size=2)
    twice, asked = np.vstack([G, G]), np.concatenate([b, b])
    value, residual = _multipliers(twice, asked)
    assert value == pytest.approx(np.linalg.pinv(twice @ twice.T, rcond=1e-9) @ asked, rel=1e-4)
    assert twice.T @ value == pytest.approx(np.linalg.solve(G, b), rel=1e-4)
    assert np.abs(residual).max() < 1e-4
    assert _rank(twice) == 2.0


def test_contradictory_rows_give_the_compromise_of_least_squares() -> None:
    random = np.random.default_rng(3)
    G, b = random.normal(size=(6, 2)) / 2, random.normal(size=6)
    value, residual = _multipliers(G, b)
    u, left, *_ = np.linalg.lstsq(G, -b, rcond=None)
    assert -G.T @ value == pytest.approx(u, rel=1e-4)
    assert np.linalg.norm(residual) == pytest.approx(np.sqrt(left[0]), rel=1e-4)
    assert residual == pytest.approx(b + G @ u, abs=1e-4)


@pytest.mark.parametrize("seed", range(20))
def test_rank_is_that_of_numpy(seed: int) -> None:
    random = np.random.default_rng(seed)
    G = random.normal(size=(6, 2)) * random.choice([0.0, 1e-5, 1.0], size=(6, 1))
    G = np.outer(G[:, 0], [0.6, 0.8]) if seed % 3 == 0 else G
    assert _rank(G) == np.linalg.matrix_rank(G, tol=np.sqrt(constraints.INDEPENDENT))


def test_rows_switched_off_or_without_direction_are_harmless() -> None:
    G, b = np.array([[0.0, 0.0], [0.6, 0.8], [0.0, 0.0]]), np.array([0.0, 2.0, 5.0])
    value, residual = _multipliers(G, b)
    assert value[0] == 0.0
    assert value[1] == pytest.approx(2.0, rel=2e-6)
    assert np.isfinite(value).all()
    assert -G.T @ value == pytest.approx([-1.2, -1.6], rel=2e-6)
    assert residual[2] == pytest.approx(5.0)
