"""The predictive controller drives the planar car: recovery, no offset, lost motors, limits, rest."""

from __future__ import annotations

import numpy as np
import pytest
from mpc_loop import PERIOD, Loop, driven, lane_change, lost, pushed, rms, steady

from fmukit.direct import Direct
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator.interface import INTERFACE

_CORRIDOR = 0.1  # m, the controller's half width
_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}


@pytest.mark.parametrize("offset", [0.3, pytest.param(-0.3, marks=pytest.mark.nightly)])
def test_initial_lateral_error_is_gone_within_half_a_second(offset: float) -> None:
    seen = Loop(lane_change(), offset).run(6.0)
    error, time = np.abs(seen["error.lateral"]), seen["time"]
    assert error[0] == pytest.approx(0.3, abs=1e-6)
    assert np.all(error[time >= 0.5] < 0.05)
    assert np.all(error[time >= 2.0] < 0.01)
    assert seen["fallback.count"][-1] == 0


def test_without_initial_error_the_time_optimal_plan_is_followed_to_millimetres() -> None:
    seen = Loop(lane_change()).run(7.0)
    assert np.max(np.abs(seen["error.lateral"])) < 0.005
    assert rms(seen["error.longitudinal"]) < 0.02
    assert np.all(seen["solver.status"] == 1)
    assert np.all(seen["allocation.status"] == 1)


def test_integral_action_holds_the_plan_against_a_side_force() -> None:
    push = pushed(1500.0)
    with_it = Loop(lane_change()).run(7.0, push)["error.lateral"]
    without = Loop(lane_change(), parameters={"integral.gain": 0.0}).run(7.0, push)["error.lateral"]
    assert rms(with_it) < 0.01
    assert rms(without) > 0.04


@pytest.mark.parametrize("curvature", [0.0, 0.008])
def test_a_constant_disturbance_leaves_no_offset(curvature: float) -> None:
    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        plant.set({"body_force.x": -600.0, "body_force.y": 900.0, "body_moment.z": 500.0})

    table = steady(20.0, curvature, 6.0)
    ends = {}
    for gain in (0.2, 0.0):
        seen = Loop(table, parameters={"integral.gain": gain}).run(5.9, hook)
        ends[gain] = [abs(seen[name][-1]) for name in ("error.lateral", "error.longitudinal")]
    assert ends[0.2][0] < 1e-3
    assert ends[0.2][1] < 4e-3  # this error dies out in seconds
    assert min(ends[0.0]) > 0.01


def test_the_disturbance_found_is_the_one_there_is() -> None:
    mass = _START["design.body.mass"]
    seen = Loop(steady(20.0, 0.0, 5.0)).run(4.9, pushed(900.0))
    found = {name: seen[f"disturbance.{name}"][-1] for name in ("lateral", "sideslip", "yaw", "speed")}
    assert found["sideslip"] == pytest.approx(900.0 / (mass * 20.0), rel=0.02)
    assert found["lateral"] == pytest.approx(0.0, abs=1e-3)
    assert found["yaw"] == pytest.approx(0.0, abs=1e-4)
    assert found["speed"] == pytest.approx(0.0, abs=0.02)


@pytest.mark.parametrize("wheel", WHEELS)
def test_a_lost_motor_keeps_the_corridor(wheel: str) -> None:
    seen = Loop(lane_change()).run(6.0, lost((wheel,), 2.5))
    assert np.max(np.abs(seen["error.lateral"])) < _CORRIDOR / 4
    after = seen["time"] >= 2.5
    assert np.all(seen[f"wheel_torque.{wheel}"][after] == 0.0)
    assert np.max(np.abs(seen[f"wheel_torque.{wheel}"][~after])) > 200.0
    assert seen["fallback.count"][-1] == 0
    residual = {name: np.abs(seen[f"residual.{name}"]) for name in ("force_x", "moment_z")}
    assert np.max(residual["force_x"]) > 1.0
    assert np.max(residual["force_x"][after]) < 300.0
    assert np.max(residual["moment_z"][after]) < 50.0


@pytest.mark.parametrize("since", [1.0, 4.0])
def test_with_all_motors_lost_the_car_rolls_along_the_path(since: float) -> None:
    table = lane_change()
    seen = Loop(table).run(7.0, lost(WHEELS, since))
    after = seen["time"] >= since
    for wheel in WHEELS:
        assert np.all(seen[f"wheel_torque.{wheel}"][after] == 0.0)
    beside = seen["car.position.y"] - np.interp(seen["car.position.x"], table[:, 1], table[:, 2])
    assert np.max(np.abs(beside)) < 0.15
    assert seen["trajectory.delay"][-1] > 0.3
    assert np.ptp(seen["command.steer_angle"][after]) > 0.01
    assert seen["fallback.count"][-1] == 0


def test_commands_keep_their_limits_and_rates() -> None:
    radius, force, rate = (_START[name] for name in ("design.wheel.radius", "limit.force", "limit.force_rate"))
    seen = Loop(lane_change(), 0.5).run(2.0)
    steer = np.concatenate([[0.0], seen["command.steer_angle"]])
    assert np.max(np.abs(np.diff(steer))) <= _START["actuator.steer_rate"] * PERIOD * (1 + 1e-9)
    for wheel in WHEELS:
        torque = np.concatenate([[0.0], seen[f"wheel_torque.{wheel}"]])
        assert np.max(np.abs(torque)) <= force * radius * (1 + 1e-9)
        assert np.max(np.abs(np.diff(torque))) <= rate * PERIOD * radius * (1 + 1e-9)
    assert np.max(np.abs(np.diff(seen["wheel_torque.fl"]))) > 0.5 * rate * PERIOD * radius  # they were reached for


def test_away_from_rest_round_bends_and_back_to_rest() -> None:
    def rise(t: np.ndarray, start: float) -> np.ndarray:
        xi = np.clip((t - start) / 4.0, 0.0, 1.0)
        return xi**3 * (10 - 15 * xi + 6 * xi**2)

    table = driven(lambda t: 15 * (rise(t, 0.5) - rise(t, 7.0)), lambda t: 0.02 * np.sin(0.7 * t) * rise(t, 0.5), 13.0)
    seen = Loop(table).run(13.0)
    assert np.max(seen["car.velocity.x"]) > 14.9
    assert np.max(np.abs(seen["error.lateral"])) < 0.03
    assert np.max(np.abs(seen["error.longitudinal"])) < 0.02
    rest = seen["time"] > 11.5
    assert np.max(np.abs(seen["car.velocity.x"][rest])) < 1e-3
    assert np.ptp(seen["command.steer_angle"][rest]) < 1e-3


@pytest.mark.parametrize("period", [pytest.param(0.01, marks=pytest.mark.nightly), 0.04, 0.1])
def test_another_sampling_period_keeps_the_plan(period: float) -> None:
    seen = Loop(lane_change(), 0.2, {"sample_period": period}).run(6.0, pushed(600.0))
    assert np.max(np.abs(seen["error.lateral"][seen["time"] >= 2.0])) < 0.02
    assert seen["fallback.count"][-1] == 0


def test_a_reference_that_moves_every_fifth_sample_is_read_ahead_meanwhile() -> None:
    held: dict[str, float] = {}

    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        ports = [name for name in INTERFACE.names("input") if name.startswith(("reference.", "preview["))]
        if round(t / PERIOD) % 5 == 0:
            held.update({name: mpc.u[INTERFACE.names("input").index(name)] for name in ports})
        mpc.set(held)

    seen = Loop(lane_change(), 0.1).run(6.0, hook)
    assert np.max(seen["trajectory.age"]) == pytest.approx(4 * PERIOD)
    assert np.max(np.abs(seen["error.lateral"][seen["time"] >= 1.0])) < 0.02
    assert np.max(np.abs(seen["error.longitudinal"])) < 0.1
    assert seen["fallback.count"][-1] == 0
