"""A car that falls behind its reference is led along the path that the reference has left behind."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mpc_loop import Array, Hook, Loop, driven, lane_change

from fmukit.direct import Direct
from fmukit.kernel import Signals, block, slots
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator import memory
from fmus.controllers.mpc_allocator.interface import INTERFACE

_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}


def _beside(seen: dict[str, Array], table: Array) -> Array:
    """Distances [m] of the car from the curve of the table."""
    fine = np.arange(0.0, table[-1, 0], 0.002)
    curve = np.column_stack([np.interp(fine, table[:, 0], table[:, k]) for k in (1, 2)])
    places = np.column_stack([seen["car.position.x"], seen["car.position.y"]])
    return np.array([np.hypot(*(curve - place).T).min() for place in places])


def _held_back(force: float, until: float, motors: tuple[float, float]) -> Hook:
    """A drag [N] down to the speed `until` [m/s]; no motors from the first time [s] to the second."""

    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        out = motors[0] <= t < motors[1]
        mpc.set({f"motor_available.{wheel}": float(not out) for wheel in WHEELS})
        plant.set({"body_force.x": -force if out and plant["velocity.x"] > until else 0.0})

    return hook


def _winding(speed: float, curvature: float, duration: float) -> Array:
    return driven(
        lambda t: np.full_like(t, speed), lambda t: curvature * np.sin(0.7 * t) * np.clip(t / 2, 0, 1), duration
    )


def test_a_slow_car_keeps_to_the_path_however_late_it_is() -> None:
    table = _winding(15.0, 0.02, 20.0)
    seen = Loop(table).run(11.5, _held_back(1800.0, 4.0, (2.0, 100.0)))
    assert seen["trajectory.delay"][-1] > 3.5
    assert np.max(_beside(seen, table)) < 0.1
    assert np.max(np.abs(seen["command.steer_angle"])) < 0.15
    assert seen["fallback.count"][-1] == 0


@pytest.mark.parametrize("period", [0.005, pytest.param(0.1, marks=pytest.mark.nightly)])
def test_lost_motors_at_another_sampling_period(period: float) -> None:
    table = lane_change()
    seen = Loop(table, parameters={"sample_period": period}).run(5.0, _held_back(1200.0, 2.0, (1.0, 100.0)))
    beside = seen["car.position.y"] - np.interp(seen["car.position.x"], table[:, 1], table[:, 2])
    assert seen["trajectory.delay"][-1] > 1.2
    assert np.max(np.abs(beside)) < 0.05


def test_when_the_memory_ends_the_car_brakes_along_it_and_says_so() -> None:
    table = _winding(38.0, 0.003, 30.0)
    loop = Loop(table)
    seen = loop.run(20.5, _held_back(6000.0, 5.0, (2.0, 17.5)))
    active = seen["fallback.active"] == 1
    assert not active[seen["time"] < 10.0].any()
    assert active[seen["time"] > 17.0].all()
    assert seen["fallback.count"][-1] == np.count_nonzero(active)
    assert np.max(_beside(seen, table)) < 0.15
    assert np.max(np.abs(seen["command.steer_angle"])) < 0.1
    braking = active & (seen["time"] > 18.0) & (seen["car.velocity.x"] > 2.0)
    slowing = -np.diff(seen["car.velocity.x"][braking]) / 0.02
    assert np.median(slowing) == pytest.approx(_START["fallback.deceleration"], abs=0.4)
    assert abs(seen["car.velocity.x"][-1]) < 0.1
    here = {"reference.x": loop.plant["position.x"], "reference.y": loop.plant["position.y"]}
    here |= {"reference.course": loop.plant["yaw"], "reference.speed": 0.0, "reference.curvature": 0.0}
    ahead = {name.replace("reference", f"preview[{k}]"): value for name, value in here.items() for k in range(1, 61)}
    found = loop.run(0.1, lambda t, mpc, plant: mpc.set(here | ahead))
    assert found["fallback.active"][-1] == 0
    assert found["trajectory.delay"][-1] == 0.0


@pytest.mark.parametrize("period", [0.005, 0.02, 0.1])
def test_the_path_is_remembered_at_any_sampling_period(period: float) -> None:
    """25 m/s through bends, ten seconds at rest, and on: told again by the memory to centimetres."""

    def ramp(t: Array, start: float) -> Array:
        xi = np.clip((t - start) / 3.0, 0.0, 1.0)
        return xi**3 * (10 - 15 * xi + 6 * xi**2)

    table = driven(lambda t: 25 * (1 - ramp(t, 6) + ramp(t, 19)), lambda t: 0.01 * np.sin(t), 24.0)
    told = {"reference.x": 1, "reference.y": 2, "reference.course": 3, "reference.speed": 4}
    times = np.arange(0.0, 24.0, period)
    samples = np.array([np.interp(times, table[:, 0], table[:, k]) for k in range(1, 7)])
    past = ca.MX.sym("past", memory.ROW, memory.PAST)
    sample = ca.MX.sym("sample", 6)
    keep = ca.Function("keep", [past, sample], [memory.remembered(past, sample, ca.MX(period))[0]])
    rows = ca.evalf(memory.straight(ca.MX(ca.DM(samples[:, 0])))).full()
    for k in range(len(times) - 1):
        rows = keep(rows, samples[:, k]).full()
    back = np.arange(-20.0, -0.1, 0.05)
    passage = memory.Passage(ca.MX(0), ca.MX(1), ca.MX(0), ca.MX(memory.SEEN))

    @block(symbol=ca.MX, u=slots(INTERFACE, "input"))
    def told_again(u: Signals) -> ca.MX:
        return memory.along(u, ca.MX(ca.DM(rows)), passage, ca.MX(ca.DM(back)))

    bus = np.zeros(len(INTERFACE.names("input")))
    for name, column in told.items():
        bus[INTERFACE.names("input").index(name)] = samples[column - 1, -1]
    again = told_again(bus).full()
    for name, row, tolerance in (("x", 0, 0.02), ("y", 1, 0.02), ("course", 2, 2e-3), ("speed", 3, 0.1)):
        wanted = np.interp(times[-1] + back, table[:, 0], table[:, row + 1])
        assert np.max(np.abs(again[row] - wanted)) < tolerance, name
    assert np.all(np.diff(rows[0]) > 0.0)


def test_what_is_read_ahead_stays_within_the_preview() -> None:
    def limits(delay: float, read: float) -> list[float]:
        past = memory.straight(ca.MX(ca.DM([0.0, 0.0, 0.0, 10.0, 0.0, 0.0])))
        found = memory.within(ca.MX(delay), past, ca.MX(read), ca.MX(10.0), 0.5)
        return [float(ca.evalf(value)) for value in found]

    for read in (0.0, 1.0, 2.0):
        delay, known = limits(-5.0, read)
        assert read - delay + memory.FASTEST * 0.5 == pytest.approx(3.0)
        assert known == 0.0
    assert limits(1e3, 0.0) == [pytest.approx(60.0), 0.0]
    assert limits(2.0, 0.0) == [2.0, 1.0]
