"""HighLevelLqr's feedback against scipy: matrix exponential, Riccati recursion, limits."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.linalg import expm, solve_discrete_are

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.controllers.high_level_lqr import COMPONENT, riccati, tracking
from fmus.controllers.high_level_lqr.model import STATES
from tests.references.error_model import continuous_model

T = 0.05
Q, R = np.diag([0.3, 0.3, 1.0, 20.0]), np.diag([0.3, 10.0])
WEIGHTS = np.concatenate([np.diag(Q), np.diag(R)])
ON_THE_PATH = {"estimate.velocity.x": 30.0, "reference.speed": 30.0} | {
    f"preview[{k}].speed": 30.0 for k in range(1, 61)
}


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def error_model(v: float, curvature: float) -> tuple[np.ndarray, np.ndarray]:
    w = v * curvature
    A = np.array([[0.0, 1.0, w, 0.0], [0.0, 0.0, 0.0, 0.0], [-w, 0.0, 0.0, v], [0.0, 0.0, 0.0, 0.0]])
    B = np.zeros((4, 2))
    B[1, 0] = B[3, 1] = 1.0
    return A, B


def discrete_model(v: float, curvature: float, period: float = T) -> tuple[np.ndarray, np.ndarray]:
    """Van Loan: the exponential of [[A, B], [0, 0]] holds Phi and Gamma."""
    A, B = error_model(v, curvature)
    block = expm(np.block([[A, B], [np.zeros((2, 6))]]) * period)
    return block[:4, :4], block[:4, 4:]


def gains(v: np.ndarray, curvature: np.ndarray, S: np.ndarray) -> np.ndarray:
    """First gain of the backward recursion over steps of speed v and curvature."""
    for A, B in (discrete_model(*pair) for pair in zip(v[::-1], curvature[::-1], strict=True)):
        K = np.linalg.solve(R + B.T @ S @ B, B.T @ S @ A)
        S = Q + A.T @ S @ A - A.T @ S @ B @ K
    return K


def terminal_weight() -> np.ndarray:
    return solve_discrete_are(*discrete_model(30.0, 0.0), Q, R)


@pytest.mark.parametrize("v", [0.0, 0.5, 12.0, 33.0, 60.0])
@pytest.mark.parametrize("curvature", [0.0, 1e-9, -0.004, 0.05, 0.2])
def test_exact_model_is_the_matrix_exponential(v: float, curvature: float) -> None:
    symbols = ca.SX.sym("v"), ca.SX.sym("curvature")
    model = ca.Function("model", list(symbols), list(tracking.exact_model(*symbols, T)))
    for given, exact in zip(model(v, curvature), discrete_model(v, curvature), strict=True):
        np.testing.assert_allclose(given.full(), exact, rtol=1e-12, atol=1e-14)


def test_continuous_model_linearises_the_kinematics() -> None:
    v, curvature, h = 20.0, 0.01, 1e-6
    A, B = continuous_model(ca.SX(v), ca.SX(curvature))
    expected = error_model(v, curvature)
    np.testing.assert_allclose(ca.DM(A).full(), expected[0])
    np.testing.assert_allclose(ca.DM(B).full(), expected[1])

    def error_rates(e: np.ndarray) -> np.ndarray:
        """Planar kinematics in the path frame: position error rotates with the frame."""
        e_s, e_v, e_n, e_psi = e
        w = v * curvature
        return np.array([(v + e_v) * np.cos(e_psi) - v + w * e_n, 0.0, (v + e_v) * np.sin(e_psi) - w * e_s, 0.0])

    columns = [(error_rates(h * unit) - error_rates(-h * unit)) / (2 * h) for unit in np.eye(4)]
    np.testing.assert_allclose(np.array(columns).T, expected[0], atol=1e-8)


def test_terminal_weight_solves_the_algebraic_riccati_equation() -> None:
    S = ca.DM(riccati.unpack(ca.SX(riccati.terminal(WEIGHTS, 30.0, 0.0)))).full()
    np.testing.assert_allclose(S, terminal_weight(), rtol=1e-9, atol=1e-9)


def test_terminal_weight_converges_for_slow_and_fast_designs() -> None:
    for scale in (1e-3, 1e4):
        weights = np.concatenate([np.diag(Q), scale * np.diag(R)])
        S = ca.DM(riccati.unpack(ca.SX(riccati.terminal(np.array(weights), 20.0, 0.0)))).full()
        exact = solve_discrete_are(*discrete_model(20.0, 0.0), Q, scale * R)
        np.testing.assert_allclose(S, exact, rtol=1e-6, atol=1e-6 * np.abs(exact).max())


def wavy(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Speed and curvature at `count` nodes of a path that turns and accelerates."""
    k = np.arange(count)
    return 25.0 + 6.0 * np.sin(0.05 * k), 0.006 * np.sin(0.21 * k)


def on_a_wavy_path() -> dict[str, float]:
    speed, curvature = wavy(61)
    inputs = {"reference.speed": speed[0], "reference.curvature": curvature[0], "estimate.velocity.x": speed[0]}
    for k in range(1, 61):
        inputs |= {f"preview[{k}].speed": speed[k], f"preview[{k}].curvature": curvature[k]}
    return inputs


def feedback(kernel: Kernel, inputs: dict[str, float], **parameters: float) -> np.ndarray:
    controller = Direct(COMPONENT, {"compensate_lag": False} | parameters, kernel=kernel)
    controller.set(on_a_wavy_path() | inputs)
    controller.sample()
    return np.array([controller["feedback.acceleration"], controller["feedback.yaw_rate"]])


def test_feedback_is_the_first_gain_of_the_finite_horizon(kernel: Kernel) -> None:
    speed, curvature = wavy(61)
    K = gains(0.5 * (speed[1:] + speed[:-1]), 0.5 * (curvature[1:] + curvature[:-1]), terminal_weight())
    inputs = ("estimate.position.x", "estimate.velocity.x", "estimate.position.y", "estimate.yaw")
    base, start = on_a_wavy_path(), feedback(kernel, {})
    for j, name in enumerate(inputs):
        moved = feedback(kernel, {name: base.get(name, 0.0) + 1e-3}, sideslip_time=1e6)
        if name == "estimate.velocity.x":
            moved = feedback(kernel, {name: base[name] + 1e-3})
        np.testing.assert_allclose((moved - start) / 1e-3, -K[:, j], rtol=1e-6, atol=1e-9)


def test_without_error_weights_only_the_feed_forward_is_left(kernel: Kernel) -> None:
    off = {f"weight.{name}": 0.0 for name in ("longitudinal", "speed", "lateral", "yaw")}
    off |= {"integral.longitudinal": 0.0, "integral.lateral": 0.0}
    aside = {"estimate.position.y": 1.0, "estimate.position.x": -2.0, "estimate.yaw": 0.1}
    np.testing.assert_array_equal(feedback(kernel, aside, **off), [0.0, 0.0])
    assert np.abs(feedback(kernel, aside)).min() > 0.1


def test_errors_in_the_frame_of_the_path(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    turned = {"reference.x": 5.0, "reference.y": -3.0, "reference.course": 2.0 + 4.0 * np.pi, "reference.speed": 10.0}
    across = np.array([-np.sin(2.0), np.cos(2.0)])
    position = np.array([5.0, -3.0]) + 0.3 * across - 0.2 * np.array([np.cos(2.0), np.sin(2.0)])
    where = {"estimate.position.x": position[0], "estimate.position.y": position[1], "estimate.yaw": 2.1}
    controller.set(turned | where | {"estimate.velocity.x": 11.0, "estimate.velocity.y": 0.11})
    controller.sample()
    assert controller["error.lateral"] == pytest.approx(0.3)
    assert controller["error.longitudinal"] == pytest.approx(-0.2)
    assert controller["error.speed"] == pytest.approx(np.hypot(11.0, 0.11) - 10.0)
    assert controller["error.yaw"] == pytest.approx(0.1)
    assert controller["error.course"] == pytest.approx(0.1 + np.arctan2(0.11, 11.0))


def test_limit_is_kept_and_stops_the_integrals(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    controller.set(ON_THE_PATH | {"estimate.position.y": 40.0, "estimate.position.x": -1.0})
    for _ in range(100):
        controller.sample()
    integrals = STATES.split(ca.DM(controller.x))["integrals"].full().ravel()
    assert controller["feedback.yaw_rate"] == pytest.approx(-0.5)
    assert integrals[1] == 0.0
    assert integrals[0] == pytest.approx(100 * 0.020 * -1.0)


def test_sideslip_that_differs_from_the_expected_one_is_learnt(kernel: Kernel) -> None:
    """A car that crabs with 1 degree on a straight is on its path: the yaw error decays to zero."""
    controller = Direct(COMPONENT, {"sideslip_time": 0.25}, kernel=kernel)
    beta = np.deg2rad(1.0)
    crab = {"estimate.velocity.x": 30.0 * np.cos(beta), "estimate.velocity.y": 30.0 * np.sin(beta)}
    controller.set(ON_THE_PATH | crab | {"estimate.yaw": -beta})
    seen = []
    for _ in range(75):
        controller.sample()
        seen.append(controller["error.yaw"])
    times = 0.02 * np.arange(75)
    np.testing.assert_allclose(seen, -beta * np.exp(-times / 0.25), atol=1e-9)
    assert controller["error.course"] == pytest.approx(0.0, abs=1e-12)
