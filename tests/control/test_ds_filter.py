"""D/S filters of LowLevelPid against scipy.signal."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy import signal

from fmukit.direct import Direct
from fmus.controllers.low_level_pid import COMPONENT, smoothing


def continuous(omega: float) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """omega^3 / (s + omega)^3 with state (r, r', r'')."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-(omega**3), -3.0 * omega**2, -3.0 * omega]])
    return A, np.array([[0.0], [0.0], [omega**3]]), np.eye(3), np.zeros((3, 1))


def discrete(omega: float, T: float) -> tuple[np.ndarray, np.ndarray]:
    """Phi (3 x 3) and Gamma (3 x 1) as the kernel computes them."""
    state, command = ca.SX.sym("state", 3), ca.SX.sym("command")
    later = smoothing.advance(smoothing.transition(ca.SX(omega), ca.SX(T)), state, command)
    jacobians = ca.Function("jacobians", [state, command], [ca.jacobian(later, state), ca.jacobian(later, command)])
    Phi, Gamma = jacobians([0.0, 0.0, 0.0], 0.0)
    return Phi.full(), Gamma.full()


@pytest.mark.parametrize("omega", [0.5, 20.0, 60.0, 500.0])
@pytest.mark.parametrize("T", [1e-4, 1e-3, 5e-2])
def test_discretisation_is_exact(omega: float, T: float) -> None:
    A, B, _, _, _ = signal.cont2discrete(continuous(omega), T, method="zoh")
    scale = omega ** np.arange(3.0)  # derivatives grow by omega
    Phi, Gamma = discrete(omega, T)
    np.testing.assert_allclose(Phi * scale / scale[:, None], A * scale / scale[:, None], rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(Gamma / scale[:, None], B / scale[:, None], rtol=1e-8, atol=1e-11)


@pytest.mark.parametrize("frequency", [3.0, 20.0, 100.0])
def test_frequency_response(frequency: float) -> None:
    """Of the discrete filter against omega^3 / (s + omega)^3 with the hold: half a period of delay."""
    omega, T = 60.0, 1e-4
    Phi, Gamma = discrete(omega, T)
    z = np.exp(1j * frequency * T)
    response = np.linalg.solve(z * np.eye(3) - Phi, Gamma).ravel()
    ideal = (omega / (1j * frequency + omega)) ** 3 * np.exp(-0.5j * frequency * T)
    np.testing.assert_allclose(response, ideal * (1j * frequency) ** np.arange(3), rtol=1e-4)


def test_commands_pass_their_filters() -> None:
    """A step of the speed command after the first sample, against scipy's simulation of the same step."""
    controller = Direct(COMPONENT)
    controller.set({"command.speed": 10.0, "command.yaw_rate": 0.1})
    controller.sample()
    assert (controller["filtered.speed"], controller["filtered.yaw_rate"]) == (10.0, 0.1)
    controller.set({"command.speed": 12.0, "command.yaw_rate": -0.1})
    seen = []
    for _ in range(400):
        controller.sample()
        seen.append((controller["filtered.speed"], controller["filtered.yaw_rate"]))
    times = 1e-3 * np.arange(400)
    for column, (start, end, omega) in enumerate(((10.0, 12.0, 20.0), (0.1, -0.1, 60.0))):
        _, step = signal.step(signal.TransferFunction([omega**3], np.poly([-omega] * 3)), T=times)
        np.testing.assert_allclose(np.array(seen)[:, column], start + (end - start) * step, atol=1e-6)
