"""LowLevelPid: limits, anti-windup, shares, switches, standing still, Ackermann geometry."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.controllers.low_level_pid import COMPONENT, steering
from fmus.controllers.low_level_pid.model import STATES

WEIGHT = DESIGN.mass * DESIGN.gravity
R = DESIGN.rolling_radius


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def run(controller: Direct, count: int, **inputs: float) -> None:
    controller.set({name.replace("__", "."): value for name, value in inputs.items()})
    for _ in range(count):
        controller.sample()


def state(controller: Direct, name: str) -> np.ndarray:
    return STATES.split(ca.DM(controller.x))[name].full().ravel()


def torques(controller: Direct, kind: str) -> np.ndarray:
    return np.array([controller[f"{kind}_torque.{w}"] for w in WHEELS])


def test_driving_force_is_limited_shared_and_does_not_wind_up(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 2000, command__speed=60.0, estimate__velocity__x=20.0)
    assert controller["saturation.drive"] == 1.0
    assert state(controller, "speed_integral") == 0.0
    np.testing.assert_allclose(torques(controller, "wheel"), 0.25 * 0.5 * WEIGHT * R)
    assert np.all(torques(controller, "brake") == 0.0)
    run(controller, 1, estimate__velocity__x=59.9)
    assert controller["saturation.drive"] == 0.0


def test_braking_goes_to_the_friction_brakes(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 500, command__speed=5.0, estimate__velocity__x=40.0)
    assert controller["saturation.drive"] == 1.0
    assert np.all(torques(controller, "wheel") == 0.0)
    np.testing.assert_allclose(torques(controller, "brake"), 0.5 * WEIGHT * R * np.array([0.62, 0.62, 0.38, 0.38]))


def test_standing_still_holds_the_brakes(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 1000, command__speed=0.0, estimate__velocity__x=0.002)
    held = torques(controller, "brake")
    run(controller, 1, estimate__velocity__x=-0.002)
    np.testing.assert_array_equal(torques(controller, "brake"), held)
    assert held.sum() == pytest.approx(0.3 * WEIGHT * R)
    assert np.all(torques(controller, "wheel") == 0.0)
    assert state(controller, "speed_integral") == 0.0
    assert np.all(np.isfinite(controller.y))


def test_starting_from_rest_releases_the_brakes(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 100)
    run(controller, 400, command__speed=1.0, command__acceleration=1.0)
    assert np.all(torques(controller, "brake") == 0.0)
    assert torques(controller, "wheel").min() > 0.0


def test_steering_demand_keeps_its_rate_and_angle(kernel: Kernel) -> None:
    controller, angles = Direct(COMPONENT, kernel=kernel), []
    run(controller, 1)
    controller.set({"command.steer_feedforward": 2.0})
    for _ in range(1500):
        controller.sample()
        angles.append(controller["steer_demand"])
    rates = np.diff(angles) / 1e-3
    assert rates.max() == pytest.approx(0.7)
    assert max(angles) == pytest.approx(0.5)
    assert controller["saturation.steering"] == 1.0


def test_yaw_integral_rests_while_the_steering_is_limited(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 1000, command__yaw_rate=3.0, estimate__velocity__x=30.0)
    assert controller["saturation.steering"] == 1.0
    assert state(controller, "yaw_integral") == 0.0
    assert controller["steer_demand"] == pytest.approx(0.2)  # yaw.limit


def test_yaw_feedback_fades_towards_rest(kernel: Kernel) -> None:
    demands = []
    for v in (0.0, 2.5, 5.0, 20.0):
        controller = Direct(COMPONENT, kernel=kernel)
        run(controller, 2, command__yaw_rate=1e-3, estimate__velocity__x=v)
        demands.append(controller["steer_demand"])
    assert demands[0] == 0.0
    assert demands[1] == pytest.approx(0.5 * demands[2], rel=1e-6)
    assert demands[2] == pytest.approx(demands[3])


def test_servo_torque_is_limited_without_windup(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 300, steer_angle__fl=-0.4, steer_angle__fr=0.4)
    assert controller["steer_torque.fl"] == 600.0
    assert controller["steer_torque.fr"] == -600.0
    assert controller["saturation.steering"] == 1.0
    np.testing.assert_array_equal(state(controller, "steer_integral"), 0.0)


def test_suspension_force_is_limited_without_windup(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, kernel=kernel)
    run(controller, 300, estimate__roll=0.3)
    forces = np.array([controller[f"suspension_force.{w}"] for w in WHEELS])
    np.testing.assert_allclose(forces, 4000.0 * np.array([-1.0, 1.0, -1.0, 1.0]))
    assert controller["saturation.suspension"] == 1.0
    np.testing.assert_array_equal(state(controller, "attitude_integral"), 0.0)


def test_every_loop_can_be_switched_off(kernel: Kernel) -> None:
    names = ("speed", "yaw", "steering", "suspension")
    controller = Direct(COMPONENT, {f"{name}.enabled": False for name in names}, kernel=kernel)
    excited = {"command.speed": 30.0, "estimate.velocity.x": 20.0, "command.yaw_rate": 0.3, "estimate.roll": 0.1}
    controller.set(excited | {"command.acceleration": 1.0, "command.steer_feedforward": 0.05})
    run(controller, 500)
    m = DESIGN.mass + 4.0 * DESIGN.wheel_inertia / R**2
    without = Direct(COMPONENT, kernel=kernel)
    run(without, 500, command__speed=20.0, estimate__velocity__x=20.0)
    fed_through = (torques(controller, "wheel") - torques(without, "wheel")).sum() / R
    assert fed_through == pytest.approx(m * 1.0, rel=1e-9)
    assert controller["steer_demand"] == pytest.approx(0.05, rel=1e-6)
    assert all(controller[f"steer_torque.{side}"] == 0.0 for side in ("fl", "fr"))
    assert all(controller[f"suspension_force.{w}"] == 0.0 for w in WHEELS)


FED = {"speed.fed_through": True, "yaw.fed_through": True}
LOOPS = {"command.speed": 30.0, "estimate.velocity.x": 20.0, "command.yaw_rate": 0.3, "command.steer_feedforward": 0.2}


def test_torques_are_fed_through_as_they_are(kernel: Kernel) -> None:
    controller = Direct(COMPONENT, FED, kernel=kernel)
    wheel, brake = [900.0, -800.0, 9000.0, -1.0], [0.0, 100.0, 12000.0, 3.0]
    commands = {f"command.wheel_torque.{w}": value for w, value in zip(WHEELS, wheel, strict=True)}
    commands |= {f"command.brake_torque.{w}": value for w, value in zip(WHEELS, brake, strict=True)}
    for v in (20.0, 0.0):  # at rest too: nothing holds the brakes
        controller.set(LOOPS | commands | {"command.speed": 0.0, "estimate.velocity.x": v})
        run(controller, 200)
        np.testing.assert_array_equal(torques(controller, "wheel"), wheel)
        np.testing.assert_array_equal(torques(controller, "brake"), brake)
        assert controller["saturation.drive"] == 0.0
        assert state(controller, "speed_integral") == 0.0


def test_the_steering_angle_is_fed_through_a_first_order_filter_only(kernel: Kernel) -> None:
    """No D/S filter: after one time constant of 10 ms the demand has come 1 - 1/e of the way."""
    controller = Direct(COMPONENT, FED, kernel=kernel)
    controller.set(LOOPS)
    run(controller, 1, command__steer_angle=0.05)
    assert controller["steer_demand"] == 0.05
    controller.set({"command.steer_angle": 0.052})
    run(controller, 11)
    assert controller["steer_demand"] == pytest.approx(0.052 - 0.002 / np.e, rel=1e-12)
    assert controller["saturation.steering"] == 0.0
    assert state(controller, "yaw_integral") == 0.0


def test_a_fed_through_steering_angle_keeps_the_limits_of_the_actuator(kernel: Kernel) -> None:
    controller, angles = Direct(COMPONENT, FED, kernel=kernel), []
    run(controller, 1)
    controller.set({"command.steer_angle": 1.9})
    for _ in range(1000):
        run(controller, 1)
        angles.append(controller["steer_demand"])
    assert np.diff(angles).max() / 1e-3 == pytest.approx(0.7)
    assert max(angles) == pytest.approx(0.5)
    assert controller["saturation.steering"] == 1.0


def test_servos_and_suspension_work_on_when_commands_are_fed_through(kernel: Kernel) -> None:
    """The same steering angle by both ways, reached: the same torques and forces."""
    measured = {"steer_angle.fl": 0.03, "steer_angle.fr": 0.03, "estimate.roll": 0.02, "estimate.velocity.x": 20.0}
    fed, closed = Direct(COMPONENT, FED, kernel=kernel), Direct(COMPONENT, {"yaw.enabled": False}, kernel=kernel)
    fed.set(measured | {"command.steer_angle": 0.04})
    closed.set(measured | {"command.steer_feedforward": 0.04})
    run(fed, 50)
    run(closed, 50)
    names = [*(f"steer_torque.{side}" for side in ("fl", "fr")), *(f"suspension_force.{w}" for w in WHEELS)]
    assert all(abs(closed[name]) > 1.0 for name in names)
    assert [fed[name] for name in names] == pytest.approx([closed[name] for name in names], rel=1e-12)


@pytest.mark.parametrize("delta", [-0.4, -0.02, 0.0, 0.1, 0.45])
def test_ackermann_wheels_share_one_centre(delta: float) -> None:
    """The perpendiculars of both front wheels meet the rear axle in the centre of the bicycle model."""
    L, d = DESIGN.l_f + DESIGN.l_r, DESIGN.track
    angles, slopes = (ca.DM(v).full().ravel() for v in steering.ackermann(ca.SX(delta), ca.SX(d / 2), ca.SX(L)))
    if delta == 0.0:
        np.testing.assert_array_equal(angles, 0.0)
    else:
        centres = L / np.tan(angles) + np.array([0.5, -0.5]) * d  # y of the centre seen from each wheel
        np.testing.assert_allclose(centres, L / np.tan(delta))
    h = 1e-6
    ahead, behind = (
        ca.DM(steering.ackermann(ca.SX(delta + s), ca.SX(d / 2), ca.SX(L))[0]).full().ravel() for s in (h, -h)
    )
    np.testing.assert_allclose(slopes, (ahead - behind) / (2 * h), rtol=1e-8)


def test_aligning_moment_is_fed_forward(kernel: Kernel) -> None:
    """Servos already at their angle hold it against pneumatic trail times front lateral force, shared by two."""
    controller = Direct(COMPONENT, {"yaw.enabled": False}, kernel=kernel)
    run(controller, 1, command__yaw_rate=0.1, estimate__velocity__x=25.0, estimate__yaw_rate=0.1)
    F_F = DESIGN.mass * 25.0 * 0.1 * DESIGN.l_r / (DESIGN.l_f + DESIGN.l_r)
    assert controller["steer_torque.fl"] == pytest.approx(0.5 * DESIGN.pneumatic_trail * F_F)
