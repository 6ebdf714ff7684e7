"""MpcAllocator on slippery roads: the friction is found, speed and steering shrink to it; dry roads change nothing."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from mpc_loop import Array, Hook, Loop, driven, lane_change

from fmukit.direct import Direct
from fmukit.kernel import Signals
from fmus.cars.published import double_track
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator import grip
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.planner.road import double_lane_change

P = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
CAR = double_track().planar
LARGEST = min(CAR.front.D / CAR.l_R, CAR.rear.D / CAR.l_F) * CAR.wheelbase / CAR.m
"""Lateral acceleration [m/s2] of the axles at their peaks."""


def road(friction: float) -> Hook:
    def hook(t: float, mpc: Direct, plant: Direct) -> None:
        plant.set({f"road_friction.{wheel}": friction for wheel in WHEELS})

    return hook


def violation(seen: dict[str, Array]) -> float:
    """How far [m] the car leaves the corridor of the lane change."""
    points = np.column_stack([seen["car.position.x"], seen["car.position.y"]])
    return double_lane_change().violation(points[(points[:, 0] >= -30.0) & (points[:, 0] <= 140.0)])


def on(friction: float, *, estimated: bool = True) -> dict[str, Array]:
    """The lane change on a road of this friction."""
    return Loop(lane_change(), parameters={"grip.enabled": float(estimated)}).run(9.0, road(friction))


def test_the_lane_change_on_friction_0_6() -> None:
    """The plan asks for 4.4 of at most 4.1 m/s2, and itself goes 0.05 m beyond the corridor between its nodes."""
    seen = on(0.6)
    assert violation(seen) < 0.08
    assert np.abs(seen["error.lateral"]).max() < 0.1
    late = seen["time"] > 7.0
    assert np.mean(seen["friction.counted"][late]) == pytest.approx(0.6, abs=0.05)
    assert seen["friction.slow"][-1] == 1.0


@pytest.mark.nightly
def test_the_lane_change_on_another_road() -> None:
    assert violation(on(0.7)) < 0.12


@pytest.mark.nightly
def test_without_the_estimate_the_corridor_is_left() -> None:
    assert violation(on(0.6, estimated=False)) > 1.0


def winding(friction: float) -> dict[str, Array]:
    """A road that winds ever more at 15 m/s: 4.5 m/s2 in the end."""
    table = driven(lambda t: np.full_like(t, 15.0), lambda t: 0.02 * np.sin(0.7 * t) * np.clip(t / 2.0, 0.0, 1.0), 20.0)
    return Loop(table, parameters={"grip.enabled": 1.0}).run(8.0, road(friction))


def test_bends_too_fast_for_the_road_are_taken_more_slowly() -> None:
    """Without the estimate the car leaves the road by metres."""
    seen = winding(0.6)
    assert np.abs(seen["error.lateral"]).max() < 0.15
    assert seen["friction.counted"][-1] == pytest.approx(0.6, abs=0.1)
    assert seen["car.velocity.x"].min() < 13.0
    assert seen["fallback.count"][-1] == 0.0


def test_a_dry_road_is_never_taken_for_a_slippery_one() -> None:
    seen, without = (Loop(lane_change(), parameters={"grip.enabled": on}).run(2.0) for on in (1.0, 0.0))
    assert np.all(seen["friction.counted"] == 1.0)
    for name in ("command.steer_angle", *(f"wheel_torque.{w}" for w in WHEELS)):
        np.testing.assert_array_equal(seen[name], without[name])


@pytest.mark.parametrize("v", [15.0, 25.0])
def test_the_braking_before_a_bend_is_that_of_constant_deceleration(v: float) -> None:
    """A bend of 60 m radius begins 40 m ahead on a road of half the friction."""
    x = np.arange(0.0, 81.0)
    ahead = np.vstack([x, np.zeros((4, x.size)), np.where(x >= 40.0, 1.0 / 60.0, 0.0)])
    p = grip.adapted(
        Signals({n: i for i, n in enumerate(INTERFACE.names("parameter"))}, ca.MX(ca.DM(list(P.values())))), ca.MX(0.5)
    )
    found = float(ca.evalf(grip.allowed(p, ca.MX(0.5), ca.MX(v), ca.MX(ca.DM(ahead)))))
    bears = P["grip.use"] * 0.5 * LARGEST * 60.0
    assert found == pytest.approx(max((bears - v**2) / 80.0, -0.5 * P["grip.deceleration"]), rel=1e-9)
