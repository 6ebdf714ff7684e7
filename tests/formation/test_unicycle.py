"""Unicycle against closed forms, scipy, impulses, the order of its quadrature, and the ports of Vehicle16Dof."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.sensors import gps, imu
from fmus.unicycle import COMPONENT
from fmus.vehicle16dof import COMPONENT as CAR

MASS, INERTIA = 1500.0, 2540.0
IDEAL = {"speed.lag": 0.0, "yaw_rate.lag": 0.0}
Values = Mapping[str, float]
Make = Callable[..., Direct]


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


@pytest.fixture
def vehicle(kernel: Kernel) -> Make:
    def make(parameters: Values | None = None, inputs: Values | None = None) -> Direct:
        return Direct(COMPONENT, parameters, inputs, kernel=kernel)

    return make


def pose(made: Direct) -> list[float]:
    return [made["position.x"], made["position.y"], made["yaw"]]


def stepped(kernel: Kernel, made: Direct, h: float, count: int) -> np.ndarray:
    """The states (x, y, psi, v, omega) after `count` substeps of exactly `h` [s]."""
    for _ in range(count):
        made.x = kernel.step(made.p, made.d, made.u, made.x, h).full().ravel()
    return np.array(made.x)


def integrated(state: list[float], u: Values, lags: tuple[float, float], duration: float) -> np.ndarray:
    """(x, y, psi, v, omega) after `duration` [s] by scipy."""

    def rates(_: float, z: np.ndarray) -> list[float]:
        psi, v, omega = z[2:]
        return [
            v * math.cos(psi),
            v * math.sin(psi),
            omega,
            (u.get("command.speed", 0.0) - v) / lags[0] + u.get("body_force.x", 0.0) / MASS,
            (u.get("command.yaw_rate", 0.0) - omega) / lags[1] + u.get("body_moment.z", 0.0) / INERTIA,
        ]

    found = solve_ivp(rates, (0, duration), state, method="DOP853", rtol=1e-13, atol=1e-13)
    return np.array(found.y[:, -1])


@pytest.mark.parametrize(("speed", "rate"), [(20.0, 0.4), (20.0, -0.4), (-5.0, 1.0), (30.0, 1e-9), (30.0, 0.0)])
def test_circle(vehicle: Make, speed: float, rate: float) -> None:
    """A chord of length v t sinc(omega t/2) towards the middle of the turn, from any place and heading."""
    start = {"initial.position.x": 3.0, "initial.position.y": -2.0, "initial.yaw": 0.7}
    made = vehicle(IDEAL | start, {"command.speed": speed, "command.yaw_rate": rate})
    for k in range(1, 101):
        made.advance(0.1)
        half = rate * 0.1 * k / 2
        chord = speed * 0.1 * k * np.sinc(half / math.pi)
        expected = [3.0 + chord * math.cos(0.7 + half), -2.0 + chord * math.sin(0.7 + half)]
        np.testing.assert_allclose(pose(made)[:2], expected, atol=1e-11)
        turned = made["yaw"] - (0.7 + 2 * half)
        assert math.sin(turned / 2) == pytest.approx(0.0, abs=1e-12)
    assert made["velocity.x"] == speed
    assert made["angular_rate.z"] == rate


def test_many_laps_end_where_they_began(vehicle: Make) -> None:
    """Nothing drifts: neither radius nor place nor heading."""
    lap = 2 * math.pi / 0.5
    made = vehicle(IDEAL, {"command.speed": 15.0, "command.yaw_rate": 0.5})
    for _ in range(15):
        made.advance(lap)
    np.testing.assert_allclose(pose(made), 0.0, atol=1e-10)
    made.advance(lap / 2)
    assert math.hypot(made["position.x"], made["position.y"]) == pytest.approx(2 * 15.0 / 0.5, abs=1e-10)


def test_nothing_moves_at_rest(vehicle: Make) -> None:
    for lags in ({}, IDEAL):
        made = vehicle({"initial.yaw": 1.0, **lags})
        made.advance(10.0)
        assert pose(made) == [0.0, 0.0, pytest.approx(1.0, abs=1e-15)]


@pytest.mark.parametrize("lags", [(0.2, 0.2), (0.5, 0.05), (0.02, 1.0)])
def test_motion_with_lags_and_pushes_is_that_of_scipy(vehicle: Make, lags: tuple[float, float]) -> None:
    commands: list[dict[str, float]] = [
        {"command.speed": 25.0, "command.yaw_rate": 0.5},
        {"command.speed": 25.0, "command.yaw_rate": -0.8, "body_force.x": 4000.0},
        {"command.speed": -3.0, "command.yaw_rate": 0.3, "body_moment.z": -1500.0},
        {},
    ]
    made = vehicle({"initial.speed": 10.0, "speed.lag": lags[0], "yaw_rate.lag": lags[1]})
    state = np.array([0.0, 0, 0, 10, 0])
    for u in commands:
        made.set(dict.fromkeys(COMPONENT.interface.names("input"), 0.0) | u)
        made.advance(1.3)
        state = integrated(list(state), u, lags, 1.3)
        x, y, psi, v, omega = state
        np.testing.assert_allclose(pose(made), [x, y, math.remainder(psi, math.tau)], atol=1e-9)
        np.testing.assert_allclose([made["velocity.x"], made["angular_rate.z"]], [v, omega], atol=1e-11)


def test_lag_in_closed_form(vehicle: Make) -> None:
    """v = v_c (1 - e^(-t/T)); what stays behind is T v_c. The same of the yaw rate."""
    made = vehicle({"speed.lag": 0.3, "yaw_rate.lag": 0.5}, {"command.speed": 20.0})
    made.advance(0.45)
    assert made["velocity.x"] == pytest.approx(20 * (1 - math.exp(-1.5)), rel=1e-13)
    assert made["acceleration.x"] == pytest.approx(20 / 0.3 * math.exp(-1.5), rel=1e-12)
    made.advance(20.0)
    assert made["position.x"] == pytest.approx(20 * (20.45 - 0.3), rel=1e-13)
    turning = vehicle({"yaw_rate.lag": 0.5}, {"command.yaw_rate": 0.1})
    turning.advance(15.0)
    assert turning["yaw"] == pytest.approx(0.1 * (15.0 - 0.5), rel=1e-12)


@pytest.mark.parametrize("lag", [1e-5, 1e-4, 1e-3])
def test_lags_far_below_the_step_lose_nothing(vehicle: Make, lag: float) -> None:
    """The distance is exact whatever the step h, and so is the yaw; the place on the arc to v omega T h."""
    made = vehicle({"speed.lag": lag, "yaw_rate.lag": lag}, {"command.speed": 20.0})
    made.advance(1.0)
    assert made["position.x"] == pytest.approx(20 * (1 - lag), rel=1e-13)
    made.set({"command.yaw_rate": 0.5})
    made.advance(1.0)
    radius = 20 / 0.5
    angle = 0.5 * (1 - lag)
    end = [20.0 + radius * math.sin(angle), radius * (1 - math.cos(angle))]
    np.testing.assert_allclose(pose(made)[:2], end, atol=20 * 0.5 * lag * 0.01)
    assert made["yaw"] == pytest.approx(angle, rel=1e-12)


def test_speed_yaw_and_distance_do_not_depend_on_the_step(kernel: Kernel, vehicle: Make) -> None:
    u = {"command.speed": 25.0, "body_force.x": 900.0}
    coarse = stepped(kernel, vehicle({"initial.speed": 5.0}, u), 1.0, 1)
    fine = stepped(kernel, vehicle({"initial.speed": 5.0}, u), 1e-3, 1000)
    np.testing.assert_allclose(coarse, fine, rtol=1e-12, atol=1e-12)
    u = {"command.speed": 25.0, "command.yaw_rate": 0.4, "body_force.x": 900.0, "body_moment.z": 300.0}
    coarse, fine = (stepped(kernel, vehicle(None, u), h, round(1 / h)) for h in (0.5, 1e-3))
    np.testing.assert_allclose(coarse[2:], fine[2:], rtol=1e-12)


def test_halving_the_step_shows_order_six(kernel: Kernel, vehicle: Make) -> None:
    u = {"command.speed": 25.0, "command.yaw_rate": 1.0}
    lags = {"speed.lag": 1.0, "yaw_rate.lag": 0.8}
    exact = integrated([0, 0, 0, 5, 0], u, (1.0, 0.8), 1.6)
    errors = [
        np.linalg.norm(stepped(kernel, vehicle({"initial.speed": 5.0, **lags}, u), h, round(1.6 / h))[:2] - exact[:2])
        for h in (0.8, 0.4, 0.2, 0.1)
    ]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[1:] == pytest.approx([6.0, 6.0], abs=0.4)
    assert errors[-1] < 1e-8


def test_push_is_impulse_over_mass(vehicle: Make) -> None:
    """Short against the lag it changes the speed by J/m; and in the end it has carried the vehicle T J/m further."""
    force, duration, lag = 5000.0, 0.01, 4.0
    impulse = force * duration / MASS
    made = vehicle({"speed.lag": lag}, {"body_force.x": force})
    made.advance(duration)
    assert made["velocity.x"] == pytest.approx(impulse, rel=duration / lag)
    assert made["acceleration.x"] == pytest.approx(force / MASS - made["velocity.x"] / lag, rel=1e-12)
    made.set({"body_force.x": 0.0})
    made.advance(40 * lag)
    assert made["position.x"] == pytest.approx(lag * impulse, rel=1e-10)
    turning = vehicle({"yaw_rate.lag": lag}, {"body_moment.z": force})
    turning.advance(duration)
    assert turning["angular_rate.z"] == pytest.approx(force * duration / INERTIA, rel=duration / lag)
    turning.set({"body_moment.z": 0.0})
    turning.advance(40 * lag)
    assert turning["yaw"] == pytest.approx(lag * force * duration / INERTIA, rel=1e-10)


def test_without_lag_a_push_moves_nothing(vehicle: Make) -> None:
    made = vehicle(IDEAL, {"body_force.x": 1e6, "body_moment.z": 1e6})
    made.advance(1.0)
    assert pose(made) == [0.0, 0.0, 0.0]
    assert made["acceleration.x"] == made["angular_acceleration.z"] == 0.0


def test_accelerations_are_those_of_the_motion(vehicle: Make) -> None:
    """Differences of the velocity in the world, turned into the body, and g upwards in what an accelerometer feels."""
    made = vehicle({"initial.speed": 12.0}, {"command.speed": 25.0, "command.yaw_rate": 0.6, "body_force.x": 800.0})
    made.advance(0.15)

    def world() -> np.ndarray:
        return made["velocity.x"] * np.array([math.cos(made["yaw"]), math.sin(made["yaw"])])

    h, before, rate_before = 1e-4, world(), made["angular_rate.z"]
    made.advance(h)
    shown = made.outputs()
    yaw, rate_now = made["yaw"], made["angular_rate.z"]
    made.advance(h)
    a_x, a_y = (world() - before) / (2 * h)
    c, s = math.cos(yaw), math.sin(yaw)
    assert shown["acceleration.x"] == pytest.approx(c * a_x + s * a_y, rel=1e-6)
    assert shown["acceleration.y"] == pytest.approx(c * a_y - s * a_x, rel=1e-6)
    assert shown["angular_acceleration.z"] == pytest.approx((made["angular_rate.z"] - rate_before) / (2 * h), rel=1e-6)
    assert rate_now > 0.1
    assert shown["specific_force.x"] == shown["acceleration.x"]
    assert shown["specific_force.y"] == shown["acceleration.y"]
    assert shown["specific_force.z"] == 9.81
    for name in ("roll", "pitch", "sideslip", "velocity.y", "velocity.z", "angular_rate.x", "acceleration.z"):
        assert shown[name] == 0.0


def test_yaw_stays_within_half_a_turn(vehicle: Make) -> None:
    made = vehicle(IDEAL, {"command.yaw_rate": 3.0})
    for k in range(1, 200):
        made.advance(0.1)
        assert made["yaw"] == pytest.approx(math.remainder(0.3 * k, math.tau), abs=1e-11)


def test_start(vehicle: Make) -> None:
    """What is set is there before the first step, with a lag or without."""
    start = {"initial.position.x": 4.0, "initial.position.y": -5.0, "initial.yaw": -2.0, "initial.speed": 7.0}
    for lags in ({}, IDEAL):
        made = vehicle(start | lags)
        assert [*pose(made), made["velocity.x"], made["position.z"]] == pytest.approx([4.0, -5.0, -2.0, 7.0, 0.54])


def test_ports_are_those_of_the_car(vehicle: Make) -> None:
    """Whatever Vehicle16Dof has too has its name, unit and causality; sensors find all they want to know."""
    theirs = {v.name: (v.causality, v.unit) for v in CAR.interface.variables}
    own = {v.name: (v.causality, v.unit) for v in COMPONENT.interface.variables}
    new = {"command.speed", "command.yaw_rate", "speed.lag", "yaw_rate.lag", "geometry.cog_height"}
    assert own.keys() - theirs.keys() == new
    assert all(own[name] == theirs[name] for name in own.keys() & theirs.keys())
    outputs = set(COMPONENT.interface.names("output"))
    for sensor in (imu, gps):
        assert {name.removeprefix("truth.") for name in sensor.COMPONENT.interface.names("input")} <= outputs
