"""MpcAllocator finds lost motors: against the closed form of its least squares, and on the planar car."""

from __future__ import annotations

import math

import casadi as ca
import numpy as np
import pytest
from mpc_loop import PERIOD, WHEEL_SPEEDS, Loop, lane_change, lost, steady

from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator import detection
from fmus.controllers.mpc_allocator.interface import INTERFACE

P = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
V, R, KEPT = 20.0, P["design.wheel.radius"], math.exp(-PERIOD / P["detection.memory"])
F_0, DELAY = P["detection.force"], P["detection.delay"]


def responses(force: float, part: float, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Response and lost 0/1 of a front wheel asked for a constant force, whose slip tells a part of it."""
    load = P["design.body.mass"] * P["design.gravity"]
    load *= P["design.geometry.rear_axle"] / (P["design.geometry.front_axle"] + P["design.geometry.rear_axle"]) / 2
    slip = part * force / (P["actuator.slip_stiffness"] * load)
    u = dict.fromkeys(INTERFACE.names("input"), 0.0) | dict.fromkeys(WHEEL_SPEEDS, V / R * (1.0 + slip))
    x, kept, found = ca.DM([0, 0, V, 0, 0, 0, 0]), ca.DM.zeros(detection.STATES.size), []
    for _ in range(samples):
        kept, response = detection.detected.function(
            ca.DM(list(P.values())), ca.DM(list(u.values())), x, ca.DM.zeros(2), ca.DM([force] * 4), kept, 1
        )
        found.append((float(response[0]), float(detection.STATES.split(kept)["lost"][0])))
    return tuple(np.array(found).T)


@pytest.mark.parametrize(("force", "part"), [(1500.0, 0.0), (-2500.0, 0.1), (900.0, 0.8), (300.0, 0.0)])
def test_the_response_is_that_of_least_squares(force: float, part: float) -> None:
    response, _ = responses(force, part, 40)
    n = 1.0 - KEPT ** np.arange(1, 41)
    np.testing.assert_allclose(response, (n * part * force**2 + F_0**2) / (n * force**2 + F_0**2), rtol=1e-9)


@pytest.mark.parametrize("force", [1000.0, 1500.0, -3000.0])
def test_a_dead_motor_is_lost_after_its_time_and_delay(force: float) -> None:
    """Half of the weight must be dead: 1 - k^n > (F_0/F)^2; from then on the delay runs."""
    low = math.ceil(math.log(1.0 - (F_0 / force) ** 2) / math.log(KEPT))
    _, found = responses(force, 0.0, 60)
    assert np.argmax(found) == low - 1 + round(DELAY / PERIOD)


def test_an_error_of_slip_below_the_force_of_detection_never_loses_a_motor() -> None:
    """Whatever is asked for: the response stays above 1 - e/(2 F_0)."""
    for force in (200.0, 500.0, F_0, 1000.0, 3000.0, -F_0):
        e = 0.95 * F_0
        response, found = responses(force, 1.0 - e / abs(force), 200)
        assert response.min() >= 1.0 - e / (2.0 * F_0) - 1e-9
        assert found.max() == 0.0


@pytest.mark.parametrize(
    ("wheel", "since"),
    [("rr", 4.0), *(pytest.param(w, t, marks=pytest.mark.nightly) for w, t in (("fl", 2.5), ("rl", 5.5), ("fr", 1.0)))],
)
def test_a_motor_lost_in_the_lane_change_is_found(wheel: str, since: float) -> None:
    seen = Loop(lane_change()).run(7.0, lost((wheel,), since, told=False))
    found = seen["time"][seen[f"motor_lost.{wheel}"] > 0.0]
    assert 0.0 < found[0] - since <= 0.2
    assert all(seen[f"motor_lost.{w}"].max() == 0.0 for w in WHEELS if w != wheel)
    assert np.abs(seen["error.lateral"]).max() < 0.02
    assert np.abs(seen[f"wheel_torque.{wheel}"][seen["time"] > found[0] + 0.2]).max() < 1e-6


def test_nothing_is_found_where_wheel_speeds_are_missing() -> None:
    """Not wired they stay zero; what is no number tells nothing, and stops nothing."""
    for value in (0.0, float("nan")):
        loop = Loop(steady(15.0, 0.02, 6.0))
        seen = loop.run(1.0, lambda t, mpc, plant, v=value: mpc.set(dict.fromkeys(WHEEL_SPEEDS, v)))
        assert all(np.all(seen[f"motor_response.{w}"] == 1.0) for w in WHEELS)
        assert seen["fallback.count"][-1] == 0.0
