"""Rest, start from rest, braking to rest; brakes and tyres that hold."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vehicle_car import Car

from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS

MakeCar = Callable[..., Car]
LOADED = {"cog_offset.x": 0.2, "cog_offset.y": -0.1, "cog_offset.z": 0.1, "payload.mass": 200.0, "payload.y": 0.3}


def brakes(torque: float) -> dict[str, float]:
    return {f"brake_torque.{w}": torque for w in WHEELS}


def travelled(run: dict[str, np.ndarray]) -> float:
    """Largest distance [m] from the first sample."""
    moved = [run[f"position.{a}"] - run[f"position.{a}"][0] for a in "xyz"]
    return float(np.sqrt(sum(m * m for m in moved)).max())


@pytest.mark.parametrize("parameters", [{}, LOADED])
@pytest.mark.parametrize("inputs", [{}, brakes(1500.0)])
def test_standing_still_for_a_minute(car: MakeCar, parameters: dict[str, float], inputs: dict[str, float]) -> None:
    run = car(parameters, inputs).run(60.0, every=0.5)
    assert travelled(run) < 1e-6
    assert abs(run["yaw"]).max() < 1e-5


def test_brakes_hold_against_a_steady_push(car: MakeCar) -> None:
    made = car({}, {**brakes(1500.0), "body_force.x": 2000.0, "body_force.y": 1500.0})
    made.run(10.0, every=0.5)
    run = made.run(60.0, every=0.5)
    assert travelled(run) < 1e-5
    assert run["slip_ratio.fl"][-1] < 0


def test_brakes_hold_against_the_motor(car: MakeCar) -> None:
    held = car({}, {**brakes(500.0), **{f"wheel_torque.{w}": 400.0 for w in WHEELS}}).run(5.0)
    assert travelled(held) < 0.01
    assert max(abs(held[f"wheel_speed.{w}"][-1]) for w in WHEELS) < 1e-6


@pytest.mark.parametrize("torque", [300.0, 1000.0, 4000.0])
def test_braking_to_rest_never_reverses_a_wheel(car: MakeCar, torque: float) -> None:
    run = car({"initial.speed": 10.0}, brakes(torque)).run(12.0, every=0.002)
    assert min(run[f"wheel_speed.{w}"].min() for w in WHEELS) > -0.02
    assert abs(run["velocity.x"][-1]) < 1e-3
    assert np.ptp(run["position.x"][-500:]) < 1e-3
    rebound = run["position.x"].max() - run["position.x"][-1]
    assert rebound < 0.06


def test_stopping_distance_of_locked_wheels_on_a_slippery_road(car: MakeCar) -> None:
    icy = {f"road_friction.{w}": 0.2 for w in WHEELS}
    run = car({"initial.speed": 10.0}, {**brakes(5000.0), **icy}).run(12.0)
    sliding = run["tyre_force_x.fl"][200] / run["tyre_force_z.fl"][200]
    assert run["wheel_speed.fl"][200] == pytest.approx(0.0, abs=1e-3)
    assert run["position.x"].max() == pytest.approx(100.0 / (2 * 9.81 * abs(sliding)), rel=0.1)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_start_from_rest(car: MakeCar, sign: float) -> None:
    torque = 150.0
    made = car({}, {f"wheel_torque.{w}": sign * torque for w in WHEELS})
    run = made.run(3.0)
    D = DESIGN
    effective = D.mass + 4 * D.wheel_inertia / D.rolling_radius**2
    resistance = D.rolling_constant * D.mass * D.gravity
    expected = (4 * torque / D.rolling_radius - resistance) / effective
    slope = (run["velocity.x"][-1] - run["velocity.x"][99]) / 2.0
    assert sign * slope == pytest.approx(expected, rel=0.03)
    assert abs(run["position.y"]).max() < 1e-9


def test_wild_inputs_stay_finite(car: MakeCar) -> None:
    rng = np.random.default_rng(3)

    def control(_: float, __: Car) -> dict[str, float]:
        return {
            **{f"wheel_torque.{w}": rng.uniform(-5000, 5000) for w in WHEELS},
            **{f"brake_torque.{w}": rng.uniform(0, 5000) for w in WHEELS},
            **{f"steer_torque.{w}": rng.uniform(-500, 500) for w in WHEELS[:2]},
            **{f"suspension_force.{w}": rng.uniform(-4000, 4000) for w in WHEELS},
            **{f"road_height.{w}": rng.uniform(-0.1, 0.1) for w in WHEELS},
            **{f"road_friction.{w}": rng.uniform(0.05, 1.0) for w in WHEELS},
        }

    run = car({"initial.speed": 5.0}).run(10.0, control, every=0.05)
    assert all(np.isfinite(column).all() for column in run.values())


def test_a_wheel_over_a_hole_lifts_off(car: MakeCar) -> None:
    run = car({}, {}).run(3.0, lambda t, _: {"road_height.rr": -0.5 if t > 0.5 else 0.0})
    assert run["tyre_force_z.rr"][-1] == 0.0
    assert run["tyre_force_x.rr"][-1] == 0.0
    assert run["tyre_force_z.fr"][-1] > 0.0
