"""Each loop of LowLevelPid on the plant it is designed for: the error must follow its differential equation."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.controllers.low_level_pid import COMPONENT

T = 1e-3
X = np.array([DESIGN.l_f, DESIGN.l_f, -DESIGN.l_r, -DESIGN.l_r])
Y = 0.5 * DESIGN.track * np.array([1.0, -1.0, 1.0, -1.0])


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def ideal(coefficients: list[float], start: list[float], times: np.ndarray) -> np.ndarray:
    """Error of the equation with the given companion row, states (int e, e[, e'])."""
    n = len(start)
    A = np.vstack([np.eye(n)[1:], [coefficients]])
    return np.array([(expm(A * t) @ start)[1] for t in times])


def double_pole(pole: float, error: float, times: np.ndarray) -> np.ndarray:
    return ideal([-(pole**2), -2.0 * pole], [0.0, error], times)


def triple_pole(pole: float, error: float, times: np.ndarray) -> np.ndarray:
    return ideal([-(pole**3), -3.0 * pole**2, -3.0 * pole], [0.0, error, 0.0], times)


@pytest.mark.parametrize("pole", [1.5, 3.0])
def test_speed(kernel: Kernel, pole: float) -> None:
    controller = Direct(COMPONENT, {"speed.pole": pole}, kernel=kernel)
    v, errors = 19.5, []
    for _ in range(1800):
        controller.set({"command.speed": 20.0, "estimate.velocity.x": v})
        controller.sample()
        errors.append(20.0 - v)
        torque = sum(controller[f"wheel_torque.{w}"] - controller[f"brake_torque.{w}"] for w in WHEELS)
        drag = 0.5 * DESIGN.air_density * DESIGN.drag_area * v**2
        rolling = DESIGN.mass * DESIGN.gravity * (9e-3 + 7.2e-5 * v + 5.038848e-10 * v**4)
        m = DESIGN.mass + 4.0 * DESIGN.wheel_inertia / DESIGN.rolling_radius**2
        v += T * (torque / DESIGN.rolling_radius - drag - rolling) / m
    expected = double_pole(pole, 0.5, T * np.arange(1800))
    np.testing.assert_allclose(errors, expected, atol=0.5 * 2e-3 * pole)
    assert expected.min() < -0.06  # the zero of the integral shows


@pytest.mark.parametrize("pole", [4.0, 8.0])
def test_yaw_rate(kernel: Kernel, pole: float) -> None:
    """Plant: I_zz r' = l_F' C_F delta with delta without lag."""
    controller = Direct(COMPONENT, {"yaw.pole": pole, "steering.filter_time": 1e-3}, kernel=kernel)
    gain = (DESIGN.l_f - DESIGN.pneumatic_trail) * DESIGN.cornering_front / DESIGN.yaw_inertia
    r, errors = 0.0, []
    controller.set({"command.yaw_rate": 1e-3, "estimate.velocity.x": 25.0})
    for _ in range(1000):
        controller.set({"estimate.yaw_rate": r})
        controller.sample()
        errors.append(1e-3 - r)
        r += T * gain * controller["steer_demand"]
    assert controller["saturation.steering"] == 0.0
    np.testing.assert_allclose(errors, double_pole(pole, 1e-3, T * np.arange(1000)), atol=1e-3 * 4e-3 * pole)


@pytest.mark.parametrize("pole", [20.0, 40.0])
def test_steering_servo(kernel: Kernel, pole: float) -> None:
    """Plant: J delta'' = T - b delta', integrated exactly over each period with the torque held."""
    controller = Direct(COMPONENT, {"steering.pole": pole}, kernel=kernel)
    J, b = DESIGN.steer_inertia, DESIGN.steer_damping
    block = expm(T * np.array([[0.0, 1.0, 0.0], [0.0, -b / J, 1.0 / J], [0.0, 0.0, 0.0]]))
    state, errors = np.array([-0.01, 0.0]), []
    for _ in range(400):
        controller.set({"steer_angle.fl": state[0], "steer_rate.fl": state[1]})
        controller.sample()
        errors.append(-state[0])
        state = block[:2, :2] @ state + block[:2, 2] * controller["steer_torque.fl"]
    expected = triple_pole(pole, 0.01, T * np.arange(400))
    np.testing.assert_allclose(errors, expected, atol=0.01 * 2e-3 * pole)


@pytest.mark.parametrize("mode", ["heave", "roll", "pitch"])
def test_suspension(kernel: Kernel, mode: str) -> None:
    """Plant: a free body on the four forces, diag(m_s, I_x, I_y) (z, roll, pitch)'' = T f, without actuator lag."""
    pole = 12.0
    controller = Direct(COMPONENT, {"suspension.lag": 1e-4}, kernel=kernel)
    geometry = np.vstack([np.ones(4), Y, -X])
    inertia = np.array([DESIGN.sprung_mass, DESIGN.roll_inertia, DESIGN.pitch_inertia])
    axis = ["heave", "roll", "pitch"].index(mode)
    q, rate, history = 0.01 * np.eye(3)[axis], np.zeros(3), []
    for _ in range(600):
        travel, speed = -geometry.T @ q, -geometry.T @ rate
        controller.set({f"suspension_travel.{w}": travel[i] for i, w in enumerate(WHEELS)})
        controller.set({f"suspension_rate.{w}": speed[i] for i, w in enumerate(WHEELS)})
        controller.set({"estimate.roll": q[1], "estimate.pitch": q[2]})
        controller.set({"estimate.roll_rate": rate[1], "estimate.pitch_rate": rate[2]})
        controller.sample()
        history.append(-q)
        acceleration = geometry @ [controller[f"suspension_force.{w}"] for w in WHEELS] / inertia
        q, rate = q + T * rate + 0.5 * T**2 * acceleration, rate + T * acceleration
    expected = np.zeros((600, 3))
    expected[:, axis] = triple_pole(pole, -0.01, T * np.arange(600))
    np.testing.assert_allclose(history, expected, atol=0.01 * 3e-3 * pole)
    assert controller["saturation.suspension"] == 0.0


def test_suspension_follows_commanded_attitude(kernel: Kernel) -> None:
    """The forces for a commanded roll and heave have no pitch moment and no warp."""
    controller = Direct(COMPONENT, kernel=kernel)
    controller.set({"command.roll": 1e-3, "command.heave": 2e-3})
    for _ in range(50):
        controller.sample()
    f = np.array([controller[f"suspension_force.{w}"] for w in WHEELS])
    assert f @ X == pytest.approx(0.0, abs=1e-6 * np.abs(f).max())
    assert f @ Y > 0.0
    assert f.sum() > 0.0
