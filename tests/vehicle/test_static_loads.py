"""Static equilibrium: wheel loads against closed forms, mass properties, a start without transients."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vehicle_car import Car

from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.vehicle16dof.interface import INTERFACE

MakeCar = Callable[..., Car]
DROP = 0.5 * (0.2474375 + 0.24335)
OFFSETS = [(x, y, z) for x in (-0.2, 0.0, 0.2) for y in (-0.1, 0.0, 0.1) for z in (-0.1, 0.0, 0.1)]


def loads(car: Car) -> np.ndarray:
    return np.array([car[f"tyre_force_z.{w}"] for w in WHEELS])


def in_series(suspension: float, tyre: float) -> float:
    return 1.0 / (1.0 / suspension + 1.0 / tyre)


def closed_form(x: float, y: float, z: float) -> np.ndarray:
    """Wheel loads [N] of the passive car with its centre of gravity shifted.

    Sides: moment m g y, magnified by the overturning of the rolled body (its contact points follow it), split by the
    roll stiffnesses. Axles: lever arms, the pitched body carrying its centre of gravity and wheel centres along.
    """
    D, W = DESIGN, DESIGN.mass * DESIGN.gravity
    k_F, k_R = D.roll_stiffness
    roll = W * y / (k_F + k_R - W * (D.cog_height + z))
    ends = [2 * in_series(k, D.tyre_stiffness) for k in (D.spring_front, D.spring_rear)]
    k_pitch = ends[0] * ends[1] / sum(ends) * D.wheelbase**2
    shift = x + W * x * (DROP + z) / (k_pitch - W * (DROP + z))
    F_F, F_R = W * (D.l_r + shift) / D.wheelbase, W * (D.l_f - shift) / D.wheelbase
    side = np.array([k_F, -k_F, k_R, -k_R]) * roll / D.track
    return np.array([F_F, F_F, F_R, F_R]) / 2 + side


@pytest.mark.parametrize("offset", OFFSETS)
def test_wheel_loads_over_cog_offsets(car: MakeCar, offset: tuple[float, float, float]) -> None:
    made = car({f"cog_offset.{a}": value for a, value in zip("xyz", offset, strict=True)})
    seen, weight = loads(made), DESIGN.mass * DESIGN.gravity
    assert seen.sum() == pytest.approx(weight, rel=1e-12)
    assert seen == pytest.approx(closed_form(*offset), rel=5e-3)


def test_stiff_springs_give_the_least_squares_loads_of_a_level_car(car: MakeCar) -> None:
    """F = A+ (m g, m g y, m g x), A = (1; y_i; x_i), of a car that its springs hold level."""
    stiff = {f"suspension.{a}.stiffness": 1e6 for a in ("front", "rear")}
    stiff |= {f"suspension.{a}.anti_roll": 0.0 for a in ("front", "rear")}
    made = car({**stiff, "tyre.vertical_stiffness": 1e6, "cog_offset.x": 0.1, "cog_offset.y": -0.05})
    y, x = DESIGN.track / 2, (DESIGN.l_f, -DESIGN.l_r)
    A = np.array([[1, 1, 1, 1], [y, -y, y, -y], [x[0], x[0], x[1], x[1]]])
    weight = DESIGN.mass * DESIGN.gravity
    assert loads(made) == pytest.approx(np.linalg.pinv(A) @ (weight * np.array([1, -0.05, 0.1])), rel=5e-3)


def test_payload_is_a_parallel_axis_point_mass(car: MakeCar) -> None:
    place, mass = np.array([-1.0, 0.3, 0.4]), 200.0
    empty, loaded = car(), car({"payload.mass": mass, **{f"payload.{a}": v for a, v in zip("xyz", place, strict=True)}})
    change = loaded.d - empty.d
    assert change[0] == pytest.approx(mass)
    assert change[1:4] == pytest.approx(mass * place)
    xx, yy, zz, xy, xz, yz = change[4:10]
    J = mass * (place @ place * np.eye(3) - np.outer(place, place))
    assert np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]) == pytest.approx(J)
    assert loads(loaded).sum() == pytest.approx((DESIGN.mass + mass) * DESIGN.gravity)


def test_cog_offset_moves_the_total_centre_of_gravity(car: MakeCar) -> None:
    moved = car({"cog_offset.x": 0.1, "cog_offset.z": -0.05}).d - car().d
    assert moved[1:4] == pytest.approx(DESIGN.mass * np.array([0.1, 0.0, -0.05]))


@pytest.mark.parametrize("speed", [0.0, 25.0])
def test_start_is_steady(car: MakeCar, speed: float) -> None:
    made = car({"initial.speed": speed, "initial.yaw": 2.0, "cog_offset.y": 0.1, "payload.mass": 200.0})
    assert abs(made["acceleration.z"]) < 1e-4
    assert abs(made["angular_acceleration.x"]) < 0.05
    assert made["velocity.x"] == pytest.approx(speed, rel=1e-3)
    assert made["yaw"] == pytest.approx(2.0)
    assert made["specific_force.z"] == pytest.approx(DESIGN.gravity, rel=1e-3)


def test_start_on_an_uneven_road(car: MakeCar) -> None:
    made = car({}, {"road_height.fl": 0.03, "road_height.rl": 0.03})
    weight, k = DESIGN.mass * DESIGN.gravity, sum(DESIGN.roll_stiffness)
    assert made["roll"] == pytest.approx(0.03 / DESIGN.track * k / (k - weight * DESIGN.cog_height), rel=0.01)
    assert abs(made["acceleration.z"]) < 1e-9


@pytest.mark.parametrize("heights", [(0.2, 0, 0, 0), (0, 0, 0, -0.5), (0.1, 0, 0, 0.1), (-50, -50, -50, -50)])
def test_equilibrium_on_uneven_roads_with_stops_and_lifted_wheels(car: MakeCar, heights: tuple[float, ...]) -> None:
    made = car({}, {f"road_height.{w}": h for w, h in zip(WHEELS, heights, strict=True)})
    assert loads(made).sum() == pytest.approx(DESIGN.mass * DESIGN.gravity, rel=1e-6)
    assert max(abs(made[f"angular_acceleration.{a}"]) for a in "xy") < 1e-3


def test_every_parameter_may_sit_at_its_limits(car: MakeCar) -> None:
    bad = []
    for v in INTERFACE.select("parameter"):
        for limit in (v.minimum, v.maximum):
            assert limit is not None, v.name
            made = car({"initial.speed": 15.0, v.name: limit}, {"steer_torque.fl": 20.0, "steer_torque.fr": 20.0})
            settled = abs(made["acceleration.z"]) < 0.5
            made.run(0.1)
            if not (settled and np.isfinite(made.y).all()):
                bad.append((v.name, limit))
    assert not bad
