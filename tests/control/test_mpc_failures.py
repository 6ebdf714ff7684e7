"""What the predictive controller does when something fails: defined, finite, counted, never silently zero."""

from __future__ import annotations

import random
from dataclasses import replace

import numpy as np
import pytest
from mpc_loop import PERIOD, Loop, driven, kernel, lane_change, steady

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.cars.wheels import WHEELS
from fmus.controllers import mpc_allocator
from fmus.controllers.mpc_allocator import model, programs
from fmus.controllers.mpc_allocator.interface import INTERFACE

_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
_ESTIMATE = [name for name in INTERFACE.names("input") if name.startswith("estimate.")]
_PLAN = 0.5  # s for which a plan can be followed
_TORQUE = _START["limit.force"] * _START["design.wheel.radius"] * (1 + 1e-9)


def _sound(outputs: dict[str, float]) -> bool:
    """All finite, commands within their limits."""
    torques = [abs(outputs[f"wheel_torque.{wheel}"]) for wheel in WHEELS]
    within = max(torques) <= _TORQUE and abs(outputs["command.steer_angle"]) <= _START["actuator.steer_limit"]
    return within and all(np.isfinite(value) for value in outputs.values())


def _turning(seconds: float) -> Loop:
    """A loop that has driven round a bend for some time."""
    loop = Loop(steady(15.0, 0.02, 6.0))
    loop.run(seconds)
    return loop


@pytest.mark.parametrize(
    "name", ["estimate.position.x", "estimate.velocity.x", "reference.course", "preview[3].curvature", "preview[60].x"]
)
@pytest.mark.parametrize("value", [float("nan"), float("inf"), 1e300])
def test_a_value_that_is_no_number_leaves_the_plan_in_force(name: str, value: float) -> None:
    loop = _turning(1.0)
    before = loop.mpc.outputs()
    broken = loop.step(lambda t, mpc, plant: mpc.set({name: value}))
    assert broken["solver.status"] == 0
    assert broken["fallback.active"] == 1
    assert broken["fallback.count"] == before["fallback.count"] + 1
    assert _sound({key: number for key, number in broken.items() if not key.startswith("car.")})
    assert broken["command.steer_angle"] == pytest.approx(before["command.steer_angle"], rel=0.05)
    assert broken["wheel_torque.rl"] == pytest.approx(before["wheel_torque.rl"], rel=0.3)
    assert broken["wheel_torque.rl"] != 0.0
    mended = loop.step()
    assert mended["fallback.active"] == 0
    assert mended["solver.status"] == 1
    assert abs(mended["error.lateral"]) < 0.01


def test_when_the_plan_has_run_out_the_car_brakes_on_the_held_steering_to_rest() -> None:
    seen = _turning(1.0).run(10.0, lambda t, mpc, plant: mpc.set({"estimate.yaw": float("nan")}))
    followed = seen["time"] - seen["time"][0] < _PLAN - 1.5 * PERIOD
    braking = ~followed & (seen["car.velocity.x"] > 1.0)
    assert np.all(seen["fallback.active"] == 1)
    assert np.ptp(seen["command.steer_angle"][braking][2:]) < 1e-9
    assert abs(seen["command.steer_angle"][-1]) > 0.02
    slowing = -np.diff(seen["car.velocity.x"][braking]) / PERIOD
    assert np.median(slowing) == pytest.approx(_START["fallback.deceleration"], abs=0.5)
    assert seen["car.velocity.x"][-1] < 1.0
    assert np.min(seen["car.velocity.x"]) > -0.5  # by dead reckoning
    assert abs(seen["car.velocity.x"][-1] - seen["car.velocity.x"][-100]) < 0.1
    assert np.all(np.diff(seen["fallback.count"]) == 1)


def test_a_broken_input_at_the_first_sample_brakes() -> None:
    mpc = Direct(mpc_allocator.COMPONENT, inputs={"estimate.yaw": float("nan")}, kernel=kernel(mpc_allocator.COMPONENT))
    mpc.sample()
    assert _sound(mpc.outputs())
    assert mpc["fallback.count"] == 1


def test_a_reference_that_has_stopped_is_followed_for_its_timeout_then_the_car_brakes() -> None:
    table = steady(15.0, 0.02, 12.0)
    loop = Loop(table)
    loop.run(1.0)
    frozen = loop.bus
    seen = loop.run(9.0, lambda t, mpc, plant: mpc.set(frozen))
    age, timeout = seen["trajectory.age"], _START["trajectory.timeout"]
    assert np.all(seen["fallback.active"][age <= timeout] == 0)
    assert np.all(seen["fallback.active"][age > timeout + 1e-9] == 1)
    read_ahead = age <= timeout
    assert np.max(np.abs(seen["error.lateral"][read_ahead])) < 0.01
    assert np.max(np.abs(seen["error.longitudinal"][read_ahead])) < 0.05
    assert seen["car.velocity.x"][-1] < 2.0


@pytest.mark.parametrize(
    "state",
    [
        {"estimate.position.x": 1e6, "estimate.position.y": -1e6},
        {"estimate.velocity.x": -80.0, "estimate.velocity.y": 60.0},
        {"estimate.yaw": 1e4, "estimate.yaw_rate": -200.0},
        {"estimate.velocity.x": 0.0, "estimate.velocity.y": 0.0, "estimate.yaw_rate": 30.0},
        {"reference.speed": 1e8, "preview[1].speed": -1e8},
        {"preview[2].curvature": 1e8},
        {"preview[4].x": -1e8, "preview[5].y": 1e8},
    ],
)
def test_an_absurd_state_still_gives_a_finite_command_and_passes(state: dict[str, float]) -> None:
    loop = _turning(0.3)
    for _ in range(3):
        outputs = loop.step(lambda t, mpc, plant: mpc.set(state))
        assert _sound({name: value for name, value in outputs.items() if not name.startswith("car.")})
    seen = loop.run(1.5)
    assert seen["fallback.active"][-1] == 0
    assert abs(seen["error.lateral"][-1]) < 0.05


def test_random_inputs_never_give_more_than_the_limits() -> None:
    draw = random.Random(3)
    mpc = Direct(mpc_allocator.COMPONENT, kernel=kernel(mpc_allocator.COMPONENT))
    sizes = {"curvature": 1.0, "course": 10.0, "yaw": 10.0, "yaw_rate": 20.0}
    for _ in range(150):
        for name in INTERFACE.names("input"):
            if name.startswith("motor_available"):
                mpc.set({name: draw.choice([0.0, 0.3, 1.0])})
            else:
                mpc.set({name: draw.gauss(0, sizes.get(name.rpartition(".")[2], 100.0))})
        mpc.sample()
        assert _sound(mpc.outputs())


@pytest.mark.parametrize("name", ["motor_available.rl", "estimate.velocity.y", "preview[9].course"])
def test_errors_are_told_while_inputs_are_unusable(name: str) -> None:
    """Of where the model says the car is; without a reference those before."""
    loop = Loop(steady(15.0, 0.0, 6.0), offset=1.0)
    before = loop.run(0.1)
    broken = loop.step(lambda t, mpc, plant: mpc.set({name: float("nan")}))
    assert broken["solver.status"] == 0
    assert abs(broken["error.lateral"]) > 0.5
    for error in (f"error.{kind}" for kind in ("longitudinal", "lateral", "speed", "course")):
        moved = before[error][-1] - before[error][-2]
        assert broken[error] == pytest.approx(before[error][-1] + moved, abs=abs(moved) + 1e-3)


def test_a_frozen_estimate_is_bridged_for_its_timeout_then_the_car_brakes() -> None:
    loop, held = Loop(lane_change()), dict[str, float]()
    loop.run(2.0)

    def frozen(t: float, mpc: Direct, plant: Direct) -> None:
        if not held:
            held.update({name: mpc.u[INTERFACE.names("input").index(name)] for name in _ESTIMATE})
        mpc.set(held)

    seen = loop.run(1.0, frozen)
    age, timeout = seen["estimate.age"], _START["estimate.timeout"]
    assert age == pytest.approx(PERIOD * np.arange(50), abs=1e-9)
    assert np.all(seen["fallback.active"] == (age > timeout))
    assert np.max(np.abs(seen["error.lateral"][age <= timeout])) < 0.01
    assert np.max(np.abs(seen["error.longitudinal"][age <= timeout])) < 0.05
    assert np.all(seen["wheel_torque.rl"][age > timeout + _PLAN + 0.1] < 0.0)
    thawed = loop.step()
    assert (thawed["estimate.age"], thawed["fallback.active"]) == (0.0, 0.0)


def test_an_estimate_that_is_new_every_third_sample_is_enough() -> None:
    held = dict[str, float]()

    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        plant.set({"body_force.y": 900.0})
        if round(t / PERIOD) % 3 == 0:
            held.update({name: mpc.u[INTERFACE.names("input").index(name)] for name in _ESTIMATE})
        mpc.set(held)

    seen = Loop(steady(20.0, 0.005, 6.0)).run(5.0, hook)
    assert np.max(seen["estimate.age"]) == pytest.approx(2 * PERIOD)
    assert seen["fallback.count"][-1] == 0
    assert np.max(np.abs(seen["error.lateral"][seen["time"] > 3.0])) < 0.02


def test_a_car_at_rest_may_send_the_same_estimate() -> None:
    rest = driven(np.zeros_like, np.zeros_like, 3.0)
    seen = Loop(rest).run(1.0)
    assert np.all(seen["estimate.age"] == 0.0)
    assert seen["fallback.count"][-1] == 0


@pytest.mark.parametrize(("period", "jump"), [(0.005, 0.1), (0.02, 0.1), (0.005, 0.3), (0.02, 0.3)])
def test_only_a_jump_of_the_estimate_is_not_learnt_from(period: float, jump: float) -> None:
    loop = Loop(steady(15.0, 0.0, 6.0), parameters={"sample_period": period})
    before = loop.run(0.4)["disturbance.lateral"][-1]
    after = loop.step(lambda t, mpc, plant: mpc.set({"estimate.position.y": plant["position.y"] + jump}))
    learnt = abs(after["disturbance.lateral"] - before) > 0.1
    assert learnt == (jump < 0.2)


def test_the_sampling_period_has_the_range_that_the_prediction_allows() -> None:
    period = next(v for v in INTERFACE.select("parameter") if v.name == "sample_period")
    assert (period.minimum, period.start, period.maximum) == (0.005, 0.02, 0.1)


@pytest.fixture(scope="module")
def hasty() -> Kernel:
    """A controller whose program may take ten iterations only, to an accuracy it cannot reach."""
    patch = pytest.MonkeyPatch()
    programs.solvers.cache_clear()
    patch.setattr(
        programs, "TRACKING", replace(programs.TRACKING, absolute=1e-14, relative=1e-14, iterations=10, adapt=0)
    )
    made = model.kernel()
    patch.undo()
    programs.solvers.cache_clear()
    return made


def test_a_program_that_is_not_solved_is_counted_and_brakes_in_the_end(hasty: Kernel) -> None:
    seen = Loop(steady(15.0, 0.0, 6.0), controller=hasty).run(2.0)
    assert np.all(seen["solver.status"] != 1)
    assert np.all(seen["fallback.active"] == 1)
    assert seen["fallback.count"][-1] == len(seen["time"])
    assert np.median(-np.diff(seen["car.velocity.x"])) / PERIOD == pytest.approx(
        _START["fallback.deceleration"], abs=0.3
    )


def test_solver_times_are_zero_unless_asked_for() -> None:
    untimed = Loop(lane_change()).run(0.2)
    assert np.all(untimed["solver.time"] == 0.0)
    assert np.all(untimed["allocation.time"] == 0.0)
    timed = Loop(lane_change(), parameters={"solver.timed": True}).run(0.2)
    assert np.all(timed["solver.time"] > 0.0)
    assert np.all(timed["allocation.time"] > 0.0)
    for name in ("command.steer_angle", "wheel_torque.fl", "solver.iterations"):
        assert np.array_equal(timed[name], untimed[name])
