"""Propagation and updates of the filter against scipy, and against one batch least-squares solution."""

import casadi as ca
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from fmukit.kernel import block
from fmus.estimator import navigation
from fmus.estimator.correction import antenna, correct
from fmus.estimator.navigation import BELIEF, STATE, noise, propagate, transition, where
from fmus.estimator.records import ASSUMED, ROW, VERDICT
from fmus.estimator.updating import Estimate, joseph

N = STATE.size
LOWER = [(i, j) for j in range(N) for i in range(j, N)]
PROCESS = np.array([3e-8, 2e-11, 9e-6, 2.5e-5, 2.5e-5, 1 / 60, 1e-8])
UNIT = np.array([0.05, -0.04, 0.4, 1.5, 6.0, 9.6])
HEADING, PLACE, VELOCITY, TILT, SPIN, PUSH, SLOW = (where(name) for name in list(STATE.sizes)[:7])
MEAN = STATE.join(
    {
        "heading": 0.7,
        "position": ca.DM([30.0, -12.0]),
        "velocity": ca.DM([29.0, 0.8]),
        "tilt": ca.DM([0.04, -0.03]),
        "gyroscope_bias": ca.DM([0.01, -0.02, 0.01]),
        "accelerometer_bias": ca.DM([0.03, -0.02]),
        "gps_error": ca.DM([0.1, 0.2]),
        "load_lean": ca.DM([0.001, 0.002]),
        "load_share": ca.DM([1e-4, 2e-4]),
    }
)
MEAN = np.array(MEAN).ravel()


def rate(z, unit=UNIT, process=PROCESS):
    """Independent restatement of z' with complex numbers: position and velocity as x + i y."""
    phi, theta = z[TILT]
    omega, force = unit[:3] - z[SPIN], unit[3:] - [*z[PUSH], 0]
    c, s = np.cos, np.sin
    euler = [[1, 0, -s(theta)], [0, c(phi), c(theta) * s(phi)], [0, -s(phi), c(theta) * c(phi)]]
    turning = np.linalg.solve(euler, omega)
    Rx = np.array([[1, 0, 0], [0, c(phi), -s(phi)], [0, s(phi), c(phi)]])
    Ry = np.array([[c(theta), 0, s(theta)], [0, 1, 0], [-s(theta), 0, c(theta)]])
    a, w = complex(*(Ry @ Rx @ force)[:2]), complex(*z[VELOCITY])
    p_dot, w_dot = np.exp(1j * z[0]) * w, a - 1j * turning[2] * w
    z_dot = np.zeros(N)
    z_dot[HEADING], z_dot[TILT] = turning[2], turning[:2]
    z_dot[PLACE], z_dot[VELOCITY] = (p_dot.real, p_dot.imag), (w_dot.real, w_dot.imag)
    z_dot[SLOW] = -process[5] * z[SLOW]
    return z_dot


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
    Qc = PROCESS[0] * A[:, SPIN] @ A[:, SPIN].T + PROCESS[2] * A[:, PUSH] @ A[:, PUSH].T
    walks = {"gyroscope_bias": PROCESS[1], "accelerometer_bias": PROCESS[3], "load_lean": PROCESS[6]}
    for name, density in (walks | {"gps_error": 2 * PROCESS[4] * PROCESS[5]}).items():
        Qc[where(name), where(name)] += density
    return Qc


MOTION = {"z": N, "unit": navigation.UNIT, "T": 1, "process": navigation.PROCESS}


def test_mean_solves_the_navigation_equation_to_third_order():
    step, gaps = block(**MOTION)(transition).function, []
    for T in (0.04, 0.02, 0.005):
        exact = solve_ivp(lambda t, z: rate(z), (0, T), MEAN, rtol=1e-13, atol=1e-13).y[:, -1]
        gaps.append(np.max(np.abs(step(MEAN, UNIT, T, PROCESS).full().ravel() - exact)))
    assert gaps[0] / gaps[1] > 6
    assert gaps[2] < 1e-7


def test_process_noise_is_the_van_loan_integral():
    A, T = jacobian(MEAN), 0.005
    _, exact = van_loan(A, densities(A), T)
    got = block(**MOTION)(noise)(MEAN, UNIT, T, PROCESS).full()
    scale = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    scale[scale == 0] = 1.0
    assert np.max(np.abs(got - exact) / scale) < 1e-3


def test_propagation_composes_and_zero_time_is_the_identity():
    step, belief = propagate, np.concatenate([MEAN, packed(some_covariance())])
    assert np.array_equal(step(belief, UNIT, 0.0, PROCESS).full().ravel(), belief)
    quiet = PROCESS * [0, 0, 0, 0, 0, 1, 0]
    for process in (quiet, PROCESS):
        once = step(belief, UNIT, 0.005, process).full().ravel()
        twice = step(step(belief, UNIT, 0.0018, process), UNIT, 0.0032, process).full().ravel()
        added = (once - step(belief, UNIT, 0.005, quiet).full().ravel())[N:]
        assert np.allclose(once[:N], twice[:N], rtol=1e-8, atol=1e-8)
        assert np.allclose(once[N:], twice[N:], rtol=1e-6, atol=1e-6 + 2e-3 * np.max(np.abs(added)))


def test_covariance_follows_the_linearised_ensemble():
    rng, step, T = np.random.default_rng(2), block(**MOTION)(transition).function, 0.005
    P = some_covariance(scale=1e-4)
    P *= 1e-8 / np.max(np.diag(P))
    cloud = rng.multivariate_normal(MEAN, P, size=4000)
    moved = step.map(4000)(cloud.T, np.tile(UNIT[:, None], 4000), T, PROCESS[:, None]).full()
    quiet = 1e-30 * PROCESS + [0, 0, 0, 0, 0, 1 / 60, 0]
    _, later = split(propagate(np.concatenate([MEAN, packed(P)]), UNIT, T, quiet))
    spread = np.sqrt(np.outer(np.diag(later), np.diag(later)))
    assert np.max(np.abs(np.cov(moved) - later) / spread) < 0.08


def test_predicted_antenna_velocity_is_the_derivative_of_its_position():
    arm, h = np.array([0.8, -0.6, 0.9]), 1e-5
    predict, step = block(z=N, unit=navigation.UNIT, arm=3)(antenna).function, block(**MOTION)(transition).function
    still = PROCESS * [1, 1, 1, 1, 1, 1e-9, 1]  # the slow error is none of the velocity
    ahead, behind = (predict(step(MEAN, UNIT, s * h, still), UNIT, arm)[0].full().ravel() for s in (1, -1))
    assert np.allclose((ahead - behind) / (2 * h), predict(MEAN, UNIT, arm)[1].full().ravel(), atol=1e-6)


def test_joseph_form_is_symmetric_and_positive_for_any_gain():
    rng, form = np.random.default_rng(3), numeric_joseph()
    for seed in range(20):
        P, K, H, R = some_covariance(seed), rng.normal(size=(N, 2)), rng.normal(size=(2, N)), rng.uniform(0, 1, 2)
        rest = np.eye(N) - K @ H
        expected = rest @ P @ rest.T + K @ np.diag(R) @ K.T
        got = form(P, K, H, H @ P @ H.T + np.diag(R)).full()
        assert np.allclose(got, expected, rtol=1e-11, atol=1e-11)
        assert np.min(np.linalg.eigvalsh(got)) > -1e-10 * np.max(np.abs(got))


def numeric_joseph():
    P, K, H, S = ca.SX.sym("P", N, N), ca.SX.sym("K", N, 2), ca.SX.sym("H", 2, N), ca.SX.sym("S", 2, 2)
    return ca.Function("joseph", [P, K, H, S], [joseph(P, K, H, S)])


def test_an_update_is_that_of_the_textbook_unless_refused():
    rng = np.random.default_rng(4)

    def updated(belief, gap, H, gate):
        estimate = Estimate(belief)
        outcome = estimate.take(gap, H, ca.SX(R0), gate=gate, used=ca.SX(1))
        return estimate.column(), outcome.nis, outcome.accepted

    H0, R0, g0 = rng.normal(size=(2, N)), np.diag(rng.uniform(0.1, 1, 2)), rng.normal(size=2)
    function, P0 = block(belief=BELIEF, gap=2, H=(2, N), gate=1)(updated).function, some_covariance()
    S = H0 @ P0 @ H0.T + R0
    belief = np.concatenate([MEAN, packed(P0)])
    column, nis, accepted = function(belief, g0, H0, 1e9)
    mean, covariance = split(column)
    assert np.allclose(mean, MEAN + P0 @ H0.T @ np.linalg.solve(S, g0))
    assert np.allclose(covariance, P0 - P0 @ H0.T @ np.linalg.solve(S, H0 @ P0))
    assert float(nis) == pytest.approx(g0 @ np.linalg.solve(S, g0))
    assert float(accepted) == 1
    refused, _, accepted = function(belief, g0, H0, 0.5 * float(nis))
    assert np.array_equal(refused.full().ravel(), belief)
    assert float(accepted) == 0


def row(heading, position, velocity, *, unit=UNIT, doubt=0.0, trust=(1e-5, 4e-4, 9e-4)):
    """A row of the history with a fix: variances of heading, position and velocity."""
    names = ("heading", "position", "velocity")
    place = {"position": ca.DM(position), "heading": heading, "place_delay": 0}
    place |= {f"{name}_variance": value for name, value in zip(names, trust[:2], strict=False)}
    drift = {"velocity": ca.DM(velocity), "velocity_variance": trust[2], "alone": 0, "drift_delay": 0}
    sensed = {"unit": ca.DM(unit), "tilt": ca.DM([0, 0]), "speed": 0}
    return ROW.join({"sensed": sensed, "place": place, "drift": drift, "doubt": doubt})


def assumed(gates, initial=0.0):
    """A column of ASSUMED with no lever arms."""
    return ASSUMED.begun(
        {"gates": ca.DM(gates), "initial": packed(initial * np.eye(N)), "course": ca.DM([0, 1e-4, 1, 1, 1])}
    )


NOTHING = VERDICT.join({"nis": ca.DM([0, 0, 0]), "accepted": ca.DM([1, 1, 1])})


def test_each_part_of_a_fix_is_refused_by_itself_and_then_changes_nothing():
    belief, trust = np.concatenate([MEAN, packed(0.01 * some_covariance())]), assumed([25.0, 30.0, 30.0])
    far = row(0.72, [1e3, 1e3], [400.0, 400.0])
    after, verdict = correct.function(belief, NOTHING, far, trust)
    assert verdict.full().ravel()[3:].tolist() == [1, 0, 0]
    assert verdict[1] > 36
    only_heading, _ = correct.function(belief, NOTHING, row(0.72, [0, 0], [0, 0], trust=(1e-5, 0, 0)), trust)
    assert np.allclose(after.full(), only_heading.full(), rtol=1e-12, atol=1e-12)
    untouched, _ = correct.function(belief, NOTHING, row(3.5, [1e3, 1e3], [400.0, 400.0]), trust)
    assert np.allclose(untouched.full().ravel(), belief, rtol=1e-14, atol=1e-14)
    doubted, verdict = correct.function(
        belief, NOTHING, row(0.72, [1e3, 1e3], [22.0, 18.0], doubt=1.0), assumed([25.0, 30.0, 30.0], 1e6)
    )
    assert verdict.full().ravel()[3:].tolist() == [1, 1, 1]
    assert abs(split(doubted)[0][PLACE[0]] + split(doubted)[0][SLOW[0]] - 1e3) < 1.0


def test_navigation_equals_batch_least_squares_on_a_linear_case():
    """Straight on with all angles known exactly: one weighted least-squares problem in all states of all times."""
    rng, K, T = np.random.default_rng(5), 15, 0.05
    process, open_gates = np.array([0, 0, 4e-3, 1e-3, 0, 0.1, 0]), assumed([1e9, 1e9, 1e9])
    known = [*PLACE, *VELOCITY, *PUSH]
    variances, m0 = np.zeros(N), np.zeros(N)
    variances[known], m0[HEADING] = [1.0, 2.0, 0.5, 0.4, 0.01, 0.02], 0.6
    m0[known] = [*rng.normal(size=4), 0.02, -0.03]
    readings = np.column_stack([np.zeros((K, 3)), rng.normal(size=(K, 2)), np.full(K, 9.81)])
    fixes = rng.normal(size=(K, 4))
    belief = ca.DM(np.concatenate([m0, packed(np.diag(variances))]))
    for reading, fix in zip(readings, fixes, strict=True):
        belief = propagate(belief, reading, T, process)
        seen = row(0.6, fix[:2], fix[2:], unit=reading, trust=(1e-4, 0.04, 0.09))
        belief, _ = correct.function(belief, NOTHING, seen, open_gates)
    mean, P = split(belief)
    expected, covariance = batch(m0[known], np.diag(variances[known]), readings[:, 3:5], fixes, 0.6, T=T)
    assert np.allclose(mean[known], expected, atol=1e-8)
    assert np.allclose(P[np.ix_(known, known)], covariance, atol=1e-9)


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
