"""Propagation and updates of the filter against scipy, and against one batch least-squares solution."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmukit.kernel import block
from fmus.estimator import navigation
from fmus.estimator.correction import LEVER, antenna, correct, joseph, update
from fmus.estimator.navigation import PACKED, STATE, noise, propagate, transition

N = STATE.size
LOWER = [(i, j) for j in range(N) for i in range(j, N)]
PROCESS = np.array([3e-8, 2e-11, 9e-6, 2.5e-5, 2.5e-5, 1 / 60])
READING = np.array([0.4, 1.5, 6.0])
MEAN = np.array([0.7, 0.01, 30.0, -12.0, 29.0, 0.8, 0.03, -0.02, 0.0, 0.0])
OPEN_GATES = np.array([1e9, 1e9, 1e9])


def rate(z, reading=READING, process=PROCESS):
    """Independent restatement of z' with complex numbers: position and velocity as x + i y."""
    r, a = reading[0] - z[1], complex(*(reading[1:] - z[6:8]))
    w = complex(z[4], z[5])
    p_dot, w_dot = np.exp(1j * z[0]) * w, a - 1j * r * w
    decay = -process[5] * z[8:10]
    return np.array([r, 0, p_dot.real, p_dot.imag, w_dot.real, w_dot.imag, 0, 0, *decay])


def jacobian(z, h=1e-6):
    return np.array([(rate(z + h * e) - rate(z - h * e)) / (2 * h) for e in np.eye(N)]).T


def packed(P):
    return np.array([P[i, j] for i, j in LOWER])


def full(column):
    P = np.zeros((N, N))
    for value, (i, j) in zip(column, LOWER, strict=True):
        P[i, j] = P[j, i] = value
    return P


def split(belief):
    belief = belief.full().ravel()
    return belief[:N], full(belief[N:])


def some_covariance(seed=1, scale=0.1):
    root = np.random.default_rng(seed).normal(size=(N, N)) * scale
    return root @ root.T + 1e-4 * np.eye(N)


def van_loan(A, Qc, T):
    """Phi and Q from one matrix exponential."""
    blocks = expm(np.block([[-A, Qc], [np.zeros((N, N)), A.T]]) * T)
    Phi = blocks[N:, N:].T
    return Phi, Phi @ blocks[:N, N:]


def densities(A):
    Qc = PROCESS[0] * np.outer(A[:, 1], A[:, 1]) + PROCESS[2] * A[:, 6:8] @ A[:, 6:8].T
    return Qc + np.diag([0, PROCESS[1], 0, 0, 0, 0, PROCESS[3], PROCESS[3], *2 * [2 * PROCESS[4] * PROCESS[5]]])


MOTION = {"z": N, "reading": navigation.READING, "T": 1, "process": navigation.PROCESS}


def test_mean_solves_the_navigation_equation():
    exact = solve_ivp(lambda t, z: rate(z), (0, 0.02), MEAN, rtol=1e-12, atol=1e-12).y[:, -1]
    step = block(**MOTION)(transition).function
    assert np.allclose(step(MEAN, READING, 0.02, PROCESS).full().ravel(), exact, rtol=0, atol=1e-10)


def test_process_noise_is_the_van_loan_integral():
    A, T = jacobian(MEAN), 0.005
    _, exact = van_loan(A, densities(A), T)
    got = block(**MOTION)(noise)(MEAN, READING, T, PROCESS).full()
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    scale[scale == 0] = 1.0
    assert np.max(np.abs(got - exact) / scale) < 1e-3


def test_propagation_composes_and_zero_time_is_the_identity():
    step, belief = propagate, np.concatenate([MEAN, packed(some_covariance())])
    assert np.array_equal(step(belief, READING, 0.0, PROCESS).full().ravel(), belief)
    quiet = PROCESS * [0, 0, 0, 0, 0, 1]
    for process in (quiet, PROCESS):
        once = step(belief, READING, 0.005, process).full().ravel()
        twice = step(step(belief, READING, 0.0018, process), READING, 0.0032, process).full().ravel()
        added = (once - step(belief, READING, 0.005, quiet).full().ravel())[N:]
        assert np.allclose(once[:N], twice[:N], rtol=1e-14)
        assert np.allclose(once[N:], twice[N:], rtol=1e-13, atol=1e-15 + 2e-3 * np.max(np.abs(added)))


def test_covariance_follows_the_linearised_ensemble():
    rng, step, T = np.random.default_rng(2), block(**MOTION)(transition).function, 0.005
    P = some_covariance(scale=1e-4)
    P *= 1e-8 / np.max(np.diag(P))
    cloud = rng.multivariate_normal(MEAN, P, size=4000)
    moved = step.map(4000)(cloud.T, np.tile(READING[:, None], 4000), T, PROCESS[:, None]).full()
    _, later = split(
        propagate(np.concatenate([MEAN, packed(P)]), READING, T, 1e-30 * PROCESS + [0, 0, 0, 0, 0, 1 / 60])
    )
    spread = np.sqrt(np.outer(np.diag(later), np.diag(later)))
    assert np.max(np.abs(np.cov(moved) - later) / spread) < 0.08


def test_predicted_antenna_velocity_is_the_derivative_of_its_position():
    arm, h = np.array([0.8, -0.6]), 1e-5
    lever = np.concatenate([arm, READING[0] * np.array([-arm[1], arm[0]])])
    predict, step = block(z=N, lever=LEVER)(antenna).function, block(**MOTION)(transition).function
    ahead, behind = (predict(step(MEAN, READING, s * h, PROCESS), lever).full().ravel() for s in (1, -1))
    now = predict(MEAN, lever).full().ravel()
    assert np.allclose((ahead - behind)[:2] / (2 * h), now[2:], atol=1e-6)


def test_joseph_form_is_symmetric_and_positive_for_any_gain():
    rng, form = np.random.default_rng(3), numeric_joseph()
    for seed in range(20):
        P = form(some_covariance(seed), rng.normal(size=(N, 4)), rng.normal(size=(4, N)), np.diag(rng.uniform(0, 1, 4)))
        P = P.full()
        assert np.allclose(P, P.T, rtol=1e-12, atol=1e-12)
        assert np.min(np.linalg.eigvalsh(P)) > -1e-10 * np.max(np.abs(P))


def numeric_joseph():
    P, K, H, R = ca.SX.sym("P", N, N), ca.SX.sym("K", N, 4), ca.SX.sym("H", 4, N), ca.SX.sym("R", 4, 4)
    return ca.Function("joseph", [P, K, H, R], [joseph(P, K, H, R)])


def test_full_gain_is_the_textbook_update():
    rng = np.random.default_rng(4)
    z, P, gap, H, R = (
        ca.SX.sym("z", N),
        ca.SX.sym("P", N, N),
        ca.SX.sym("g", 4),
        ca.SX.sym("H", 4, N),
        ca.SX.sym("R", 4, 4),
    )
    function = ca.Function("u", [z, P, gap, H, R], update(z, P, gap, H, R, own=slice(0, N), gate=1e9, doubt=ca.SX(0)))
    P0, H0, R0, g0 = some_covariance(), rng.normal(size=(4, N)), np.diag(rng.uniform(0.1, 1, 4)), rng.normal(size=4)
    S = H0 @ P0 @ H0.T + R0
    mean, covariance, nis, accepted = (out.full() for out in function(MEAN, P0, g0, H0, R0))
    assert np.allclose(mean.ravel(), MEAN + P0 @ H0.T @ np.linalg.solve(S, g0))
    assert np.allclose(covariance, P0 - P0 @ H0.T @ np.linalg.solve(S, H0 @ P0))
    assert nis == pytest.approx(g0 @ np.linalg.solve(S, g0))
    assert accepted == 1


def test_each_stage_corrects_its_own_states_only_and_a_refused_fix_changes_nothing():
    belief, lever = np.concatenate([MEAN, packed(some_covariance())]), np.array([0.3, -0.2, 0.05, 0.1])
    far, trust = np.array([1e3, 1e3, 40.0, 40.0, 0.72]), np.array([4e-4, 9e-4, 1e-5, 25.0, 36.0, 10.0])
    after, nis, accepted = correct(belief, far, lever, trust, 0, np.zeros(PACKED))
    mean, _ = split(after)
    assert accepted.full().ravel().tolist() == [1, 0]
    assert nis[1] > 36
    assert np.array_equal(mean[2:8], MEAN[2:8])
    assert mean[0] != MEAN[0]
    untouched, *_ = correct(belief, far + np.array([0, 0, 0, 0, 3]), lever, trust, 0, np.zeros(PACKED))
    assert np.allclose(untouched.full().ravel(), belief, rtol=1e-14, atol=1e-14)
    doubted, _, accepted = correct(belief, far, lever, trust, 1, packed(1e6 * np.diag([1, *7 * [1], 0, 0])))
    assert accepted.full().ravel().tolist() == [1, 1]
    assert abs(split(doubted)[0][2] - 1e3) < 1.0


def test_stage_2_equals_batch_least_squares_on_a_linear_case():
    """Straight on with the heading known exactly: one weighted least-squares problem in all states of all times."""
    rng, K, T = np.random.default_rng(5), 15, 0.05
    process = np.array([0, 0, 4e-3, 1e-3, 0, 0.1])
    P0 = np.diag([0, 0, 1.0, 2.0, 0.5, 0.4, 0.01, 0.02, 0, 0])
    readings = np.column_stack([np.zeros(K), rng.normal(size=(K, 2))])
    fixes = rng.normal(size=(K, 4))
    m0 = np.array([0.6, 0, *rng.normal(size=4), 0.02, -0.03, 0, 0])
    trust = np.concatenate([[0.04, 0.09, 1e-4], OPEN_GATES])
    belief = ca.DM(np.concatenate([m0, packed(P0)]))
    step, fixing = propagate, correct
    for reading, fix in zip(readings, fixes, strict=True):
        belief = step(belief, reading, T, process)
        belief, _, _ = fixing(belief, np.append(fix, 0.6), np.zeros(4), trust, 0, np.zeros(PACKED))
    mean, P = split(belief)
    expected, covariance = batch(m0[2:8], P0[2:8, 2:8], readings[:, 1:], fixes, 0.6, T=T)
    assert np.allclose(mean[2:8], expected, atol=1e-8)
    assert np.allclose(P[2:8, 2:8], covariance, atol=1e-9)


def batch(m0, P0, accelerations, fixes, psi, *, T):
    """Gauss-Markov estimate of the last [p, w, b_a] from the prior, the noisy dynamics and all fixes at once."""
    R = np.array([[np.cos(psi), -np.sin(psi)], [np.sin(psi), np.cos(psi)]])
    A = np.zeros((6, 6))
    A[0:2, 2:4], A[2:4, 4:6] = R, -np.eye(2)
    B = np.zeros((6, 2))
    B[2:4] = np.eye(2)
    Qc = np.diag([0, 0, 4e-3, 4e-3, 1e-3, 1e-3])
    Phi, Q, drive = discretised(A, Qc, B, T)
    K, H = len(fixes), np.block([[np.eye(2), np.zeros((2, 4))], [np.zeros((2, 2)), R, np.zeros((2, 2))]])
    rows, right = [np.hstack([whiten(P0), np.zeros((6, 6 * K))])], [whiten(P0) @ m0]
    R_fix = np.diag([0.04, 0.04, 0.09, 0.09])
    for k in range(K):
        link, look = np.zeros((6, 6 * (K + 1))), np.zeros((4, 6 * (K + 1)))
        link[:, 6 * k : 6 * k + 6], link[:, 6 * k + 6 : 6 * k + 12] = -Phi, np.eye(6)
        look[:, 6 * k + 6 : 6 * k + 12] = H
        rows += [whiten(Q) @ link, whiten(R_fix) @ look]
        right += [whiten(Q) @ drive @ accelerations[k], whiten(R_fix) @ fixes[k]]
    J = np.vstack(rows)
    information = J.T @ J
    return np.linalg.solve(information, J.T @ np.concatenate(right))[-6:], np.linalg.inv(information)[-6:, -6:]


def discretised(A, Qc, B, T):
    blocks = expm(np.block([[-A, Qc], [np.zeros((6, 6)), A.T]]) * T)
    Phi = blocks[6:, 6:].T
    drive = expm(np.block([[A, B], [np.zeros((2, 8))]]) * T)[:6, 6:]
    return Phi, Phi @ blocks[:6, 6:], drive


def whiten(P):
    """W with W' W = P^-1."""
    return np.linalg.inv(np.linalg.cholesky(P))
