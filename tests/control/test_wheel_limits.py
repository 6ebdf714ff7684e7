"""LowLevelPid: the limits of slip, of unequal brakes and of motors, on wheels whose motion is known in closed form."""

from __future__ import annotations

import numpy as np
import pytest

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.controllers.low_level_pid import COMPONENT

T, R, J = 1e-3, DESIGN.rolling_radius, DESIGN.wheel_inertia
FED = {"speed.fed_through": True, "yaw.fed_through": True}


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def commanded(kernel: Kernel, speed: float, parameters: dict[str, float] | None = None) -> Direct:
    """A controller whose torques are fed through, of a car that drives straight ahead with rolling wheels."""
    controller = Direct(COMPONENT, FED | (parameters or {}), kernel=kernel)
    controller.set({"estimate.velocity.x": speed} | all_("wheel_speed", speed / R))
    return controller


def all_(name: str, value: float) -> dict[str, float]:
    return {f"{name}.{w}": value for w in WHEELS}


def torques(controller: Direct, kind: str) -> np.ndarray:
    return np.array([controller[f"{kind}_torque.{w}"] for w in WHEELS])


def driven_wheels(
    controller: Direct, speed: float, load: np.ndarray, command: dict[str, float], count: int
) -> tuple[np.ndarray, np.ndarray]:
    """Slips and brake torques (count x 4) of wheels of inertia J that the road turns with at most the torque `load`."""
    spin, slips, brakes = np.full(4, speed / R), [], []
    controller.set(command)
    for _ in range(count):
        controller.set(dict(zip((f"wheel_speed.{w}" for w in WHEELS), spin, strict=True)))
        controller.sample()
        given = torques(controller, "wheel") - torques(controller, "brake") * np.sign(speed)
        slip = (spin * R - speed) / speed
        road = load * np.clip(-slip * np.sign(speed) / 0.01, -1.0, 1.0)
        spin = spin + T / J * (given + road)
        slips.append(slip)
        brakes.append(torques(controller, "brake"))
    return np.array(slips), np.array(brakes)


@pytest.mark.parametrize("speed", [20.0, -20.0])
def test_braked_wheels_settle_at_their_limit(kernel: Kernel, speed: float) -> None:
    """Whatever is asked, forwards and backwards: slip at the limits, brakes at what the road gives, no overshoot."""
    controller = commanded(kernel, speed)
    slips, brakes = driven_wheels(controller, speed, np.full(4, 300.0), all_("command.brake_torque", 1500.0), 600)
    np.testing.assert_allclose(slips[-1], [-0.06, -0.06, -0.04, -0.04], rtol=1e-3)
    np.testing.assert_allclose(brakes[-1], 300.0, rtol=1e-3)
    assert slips.min() > -0.09
    assert all(controller[f"saturation.wheel.{w}"] == 1.0 for w in WHEELS)


def test_driven_wheels_settle_at_their_limit(kernel: Kernel) -> None:
    controller = commanded(kernel, 20.0)
    slips, _ = driven_wheels(controller, 20.0, np.full(4, 300.0), all_("command.wheel_torque", 900.0), 600)
    np.testing.assert_allclose(slips[-1], [0.06, 0.06, 0.04, 0.04], rtol=1e-3)
    np.testing.assert_allclose(torques(controller, "wheel"), 300.0, rtol=1e-3)


def test_the_way_to_the_limit_follows_the_error_equation(kernel: Kernel) -> None:
    """With the load known, e = omega - omega_lim falls by exp(-lambda t)."""
    controller = commanded(kernel, 20.0, {"slip.pole": 60.0, "slip.observer": 1000.0})
    spin, errors = np.full(4, 20.0 / R), []
    controller.set(all_("command.brake_torque", 5000.0))
    for _ in range(60):
        controller.set(dict(zip((f"wheel_speed.{w}" for w in WHEELS), spin, strict=True)))
        controller.sample()
        spin = spin + T / J * (200.0 - torques(controller, "brake"))
        errors.append(spin - 20.0 * (1.0 - np.array([0.06, 0.06, 0.04, 0.04])) / R)
    # the first samples take the load wanted for the load there is
    settled = np.array(errors)[10:]
    np.testing.assert_allclose(settled, settled[0] * np.exp(-60.0 * T * np.arange(50))[:, None], rtol=0.12)


def test_unequal_release_grows_at_its_rate(kernel: Kernel) -> None:
    """The left side finds a quarter of the grip: from the moment it gives way the difference grows as a ramp."""
    rate = 1000.0
    controller = commanded(kernel, 20.0, {"slip.yaw_moment_rate": rate})
    load = np.array([200.0, 800.0, 200.0, 800.0])
    _, brakes = driven_wheels(controller, 20.0, load, all_("command.brake_torque", 700.0), 500)
    moment = (brakes[:, 1] - brakes[:, 0]) / R * DESIGN.track / 2.0
    growth = np.diff(moment) / T
    assert growth.max() == pytest.approx(rate, rel=1e-6)
    assert moment[-1] == pytest.approx(0.5 * rate, rel=0.05)


def test_a_difference_that_was_commanded_is_left_alone(kernel: Kernel) -> None:
    wanted = {"fl": 0.0, "fr": 400.0, "rl": 100.0, "rr": 0.0}
    controller = commanded(kernel, 20.0)
    load = np.full(4, 800.0)
    _, brakes = driven_wheels(controller, 20.0, load, {f"command.brake_torque.{w}": b for w, b in wanted.items()}, 50)
    np.testing.assert_array_equal(brakes, [list(wanted.values())] * 50)


def test_brakes_give_way_before_braking_motors(kernel: Kernel) -> None:
    controller = commanded(kernel, 20.0)
    command = all_("command.brake_torque", 500.0) | all_("command.wheel_torque", -200.0)
    driven_wheels(controller, 20.0, np.full(4, 300.0), command, 600)
    np.testing.assert_allclose(torques(controller, "brake"), 100.0, rtol=1e-2)
    np.testing.assert_allclose(torques(controller, "wheel"), -200.0)
    driven_wheels(controller, 20.0, np.full(4, 150.0), command, 600)
    np.testing.assert_array_equal(torques(controller, "brake"), 0.0)
    np.testing.assert_allclose(torques(controller, "wheel"), -150.0, rtol=1e-2)


@pytest.mark.parametrize("parameters", [{"slip.enabled": False}, {}])
def test_without_wheel_speeds_slip_is_not_limited(kernel: Kernel, parameters: dict[str, float]) -> None:
    """Zeros from the start are wires that are missing; switched off, nothing is limited either."""
    controller = commanded(kernel, 20.0, parameters)
    controller.set(all_("wheel_speed", 0.0) | all_("command.brake_torque", 900.0))
    for _ in range(20):
        controller.sample()
    np.testing.assert_array_equal(torques(controller, "brake"), 900.0)


def test_motors_keep_their_power_and_speed(kernel: Kernel) -> None:
    controller = commanded(kernel, 30.0, {"slip.enabled": False})
    controller.set({f"command.wheel_torque.{w}": t for w, t in zip(WHEELS, (5000.0, -5000.0, 400.0, 0.0), strict=True)})
    controller.sample()
    limit = 65000.0 / (30.0 / R)
    np.testing.assert_allclose(torques(controller, "wheel"), [limit, -limit, 400.0, 0.0])
    controller.set(all_("wheel_speed", 200.0))
    controller.sample()
    np.testing.assert_allclose(torques(controller, "wheel"), [0.0, -325.0, 0.0, 0.0])
