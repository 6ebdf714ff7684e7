"""The lag coordinates of HighLevelLqr against the lagging car written out with all its states."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm

from fmukit.direct import Direct
from fmus.cars.nominal import DESIGN
from fmus.controllers.high_level_lqr import COMPONENT, lag, leads, tracking
from fmus.controllers.high_level_lqr.interface import INTERFACE
from tests.references.error_model import continuous_model

T = 0.05
PARAMETERS = {v.name: float(v.start) for v in INTERFACE.select("parameter")}
P = {name: ca.SX(value) for name, value in PARAMETERS.items()}
TAU = float(ca.DM(leads.yaw_rate(P)))
L_F, L_R = DESIGN.l_f - DESIGN.pneumatic_trail, DESIGN.l_r + DESIGN.pneumatic_trail


def lagging_car(v: float) -> np.ndarray:
    """Rates of (e_s, e_v, e_n, e_psi, beta, q; da, dw) on a straight."""
    a = (L_F + L_R) * DESIGN.cornering_rear / (L_F * DESIGN.mass * v)
    A = np.zeros((8, 8))
    A[0, 1] = A[1, 6] = A[3, 5] = 1.0
    A[2, 3] = A[2, 4] = v
    A[4, 4], A[4, 5] = -a, -(1.0 - a * L_R / v)
    A[5, 5], A[5, 7] = -1.0 / TAU, 1.0 / TAU
    return A


def seen(v: float, state: np.ndarray) -> np.ndarray:
    return ca.DM(lag.undo(P, ca.SX(state[:4]), ca.SX(v), ca.SX(state[4]), ca.SX(state[5]))).full().ravel()


@pytest.mark.parametrize("v", [5.0, 15.0, 33.0])
def test_four_integrators_remain(v: float) -> None:
    """Any state under any held input: transforming then advancing equals advancing then transforming."""
    random = np.random.default_rng(2)
    Phi, Gamma = (ca.DM(m).full() for m in tracking.exact_model(ca.SX(v), ca.SX(0.0), T, lag.reach(P, ca.SX(v))))
    for _ in range(5):
        state, du = random.normal(size=6), random.normal(size=2)
        later = expm(lagging_car(v) * T) @ np.concatenate([state, du])
        np.testing.assert_allclose(Phi @ seen(v, state) + Gamma @ du, seen(v, later[:6]), rtol=1e-9, atol=1e-9)


def test_rear_axle_answers_at_once() -> None:
    """Sideslip of a car whose yaw rate is held: the transient of the single-track with the front force it needs."""
    v, r = 20.0, 0.1
    a = (L_F + L_R) * DESIGN.cornering_rear / (L_F * DESIGN.mass * v)
    beta = 0.02
    F_R = -DESIGN.cornering_rear * (beta - L_R * r / v)
    F_F = L_R * F_R / L_F  # no yaw acceleration
    rate = (F_F + F_R) / (DESIGN.mass * v) - r
    assert rate == pytest.approx(-a * beta - (1.0 - a * L_R / v) * r, rel=1e-12)
    assert float(ca.DM(lag.slide(P, ca.SX(v)))) == pytest.approx(v / a, rel=1e-12)


def test_answer_is_a_first_order_lag() -> None:
    q = 0.0
    for k in range(20):
        assert q == pytest.approx(0.3 * (1.0 - np.exp(-k * 0.020 / TAU)))
        q = float(ca.DM(lag.answer(P, ca.SX(q), ca.SX(0.3))))


@pytest.mark.parametrize("curvature", [0.0, 0.01])
def test_reach_enters_the_discrete_input_exactly(curvature: float) -> None:
    v, reach = 20.0, 7.0
    A, B = (ca.DM(m).full() for m in continuous_model(ca.SX(v), ca.SX(curvature)))
    B[2, 1] -= reach
    block = expm(np.block([[A, B], [np.zeros((2, 6))]]) * T)
    Phi, Gamma = (ca.DM(m).full() for m in tracking.exact_model(ca.SX(v), ca.SX(curvature), T, reach))
    np.testing.assert_allclose(Phi, block[:4, :4], rtol=1e-12, atol=1e-14)
    np.testing.assert_allclose(Gamma, block[:4, 4:], rtol=1e-12, atol=1e-14)


def offset(compensated: bool) -> np.ndarray:
    """Lateral error of the lagging car at 30 m/s on a straight from 0.3 m to the left, 4 s."""
    v, controller = 30.0, Direct(COMPONENT, {"compensate_lag": compensated})
    controller.set({"reference.speed": v} | {f"preview[{k}].speed": v for k in range(1, 61)})
    Phi = expm(lagging_car(v) * PARAMETERS["sample_period"])
    state, rows = np.array([0.0, 0.0, 0.3, 0.0, 0.0, 0.0]), []
    for _ in range(200):
        rows.append(state[2])
        beta = state[4]
        controller.set({"estimate.position.y": state[2], "estimate.yaw": state[3]})
        controller.set({"estimate.velocity.x": v * np.cos(beta), "estimate.velocity.y": v * np.sin(beta)})
        controller.sample()
        state = (Phi @ [*state, 0.0, controller["feedback.yaw_rate"]])[:6]
    return np.array(rows)


def test_compensation_damps_the_lateral_loop() -> None:
    with_it, without = offset(True), offset(False)
    assert with_it.min() > -0.15 * 0.3
    assert np.abs(with_it[100:]).max() < 0.03
    assert without.min() < -0.25 * 0.3
