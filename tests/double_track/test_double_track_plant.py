"""DoubleTrack against the planner's equations, closed forms, a mirror, rest, and the order of its integrator."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.cars.published import double_track
from fmus.cars.wheels import WHEELS
from fmus.double_track import COMPONENT, model
from tests.references.steady_turn import understeer_gradient

CAR = double_track()
P = CAR.planar
PARAMETERS = {v.name: float(v.start) for v in COMPONENT.interface.select("parameter")}
Values = Mapping[str, float]
Make = Callable[..., Direct]


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


@pytest.fixture
def car(kernel: Kernel) -> Make:
    def make(parameters: Values | None = None, inputs: Values | None = None) -> Direct:
        return Direct(COMPONENT, parameters, inputs, kernel=kernel)

    return make


def run(car: Direct, duration: float, control: Callable[[float], Values] = lambda t: {}, every: float = 0.01) -> None:
    for k in range(round(duration / every)):
        car.set(control(k * every))
        car.advance(every)


def wheels(name: str, *values: float) -> dict[str, float]:
    return {f"{name}.{wheel}": value for wheel, value in zip(WHEELS, values, strict=True)}


@pytest.mark.parametrize("friction", [None, 0.9])
def test_motion_is_that_of_the_planners_equations(car: Make, friction: float | None) -> None:
    """Motor and brake on all wheels, a turn at 25 m/s; the planner's x' integrated by scipy in its own states."""
    f, torque, brake, steer = model.function(CAR, friction), (150, 200, -20, 120), (20, 0, 30, 10), 0.02
    U = (np.array(torque) - np.array(brake)) / P.R
    lag, limit, load = (PARAMETERS[name] for name in ("steering.lag", "steering.rate_limit", "load.lag"))

    def rates(_: float, z: np.ndarray) -> np.ndarray:
        x, a = z[:7], z[7:]
        rate = min(max((steer - x[6]) / lag, -limit), limit)
        x_dot, acceleration = (value.full().ravel() for value in f(x, [rate, *U], a)[:2])
        return np.concatenate([x_dot, (acceleration - a) / load])

    start = [3.0, -2.0, 25.0, 0, 0.4, 0, 0, 0, 0]
    # the steering rate leaves its limit here, a kink no integrator should step across
    kink = (steer - limit * lag) / limit
    mid = solve_ivp(rates, (0, kink), start, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    x = solve_ivp(rates, (kink, 3.0), mid, method="DOP853", rtol=1e-11, atol=1e-11).y[:, -1]
    plant = car(
        {
            "initial.position.x": 3.0,
            "initial.position.y": -2.0,
            "initial.yaw": 0.4,
            "initial.speed": 25.0,
            "tyre.combined_slip": friction is not None,
            "tyre.friction": friction or 1.0,
        },
        {**wheels("wheel_torque", *torque), **wheels("brake_torque", *brake), "command.steer_angle": steer},
    )
    run(plant, 3.0)
    names = ("position.x", "position.y", "velocity.x", "velocity.y", "yaw", "angular_rate.z", "steer_angle.fl")
    yaw = math.atan2(math.sin(x[4]), math.cos(x[4]))
    expected = [x[0], x[1], x[2] * math.cos(x[3]), x[2] * math.sin(x[3]), yaw, x[5], x[6]]
    np.testing.assert_allclose([plant[name] for name in names], expected, rtol=1e-6, atol=1e-6)
    assert plant["sideslip"] == pytest.approx(x[3], abs=1e-6)
    found = f(x[:7], [0, *U], x[7:])
    for name, column in (("tyre_force_z", 2), ("tyre_force_x", 3), ("tyre_force_y", 4)):
        np.testing.assert_allclose(
            [plant[f"{name}.{w}"] for w in WHEELS], found[column].full().ravel(), rtol=1e-6, atol=1e-3
        )
    # the planner counts slip from the velocity to the wheel, the plant from the wheel to the velocity
    slips = [-plant[f"slip_angle.{w}"] for w in WHEELS]
    np.testing.assert_allclose(slips, found[5].full().ravel(), atol=1e-7)
    assert abs(plant["acceleration.y"]) > 2.0


def test_coast_down(car: Make) -> None:
    """m v' = -f_r m g - c_w A rho v^2/2 with rolling resistance by thesis eq. (3.6), and the energy that is lost."""
    area = 0.5 * 0.3 * 1.249512 * 1.4378946874

    def rates(_: float, z: np.ndarray) -> list[float]:
        v = z[1]
        force = (9e-3 + 7.2e-5 * v + 5.038848e-10 * v**4) * 1239.0 * 9.81 + area * v * v
        return [v, -force / 1239.0, force * v]

    distance, speed, work = solve_ivp(rates, (0, 20), [0, 30, 0], method="DOP853", rtol=1e-10, atol=1e-10).y[:, -1]
    plant = car({"initial.speed": 30.0})
    run(plant, 20.0, every=0.05)
    assert plant["velocity.x"] == pytest.approx(speed, rel=1e-6)
    assert plant["position.x"] == pytest.approx(distance, rel=1e-6)
    assert 0.5 * 1239.0 * (900 - plant["velocity.x"] ** 2) == pytest.approx(work, rel=1e-6)


def test_steady_circle_has_the_understeer_of_the_single_track_car(car: Make) -> None:
    """delta = L r/v + K a_y, K = m (l_R/C_F - l_F/C_R)/L; without resistance, which would add a drive force."""
    nothing = dict.fromkeys(("rolling.constant", "rolling.linear", "rolling.quartic", "body.drag_coefficient"), 0.0)
    for speed in (10.0, 20.0, 30.0):
        delta = 0.5 * P.wheelbase / speed**2
        plant = car({**nothing, "initial.speed": speed}, {"command.steer_angle": delta})
        run(plant, 5.0)
        v, r = plant["velocity.x"], plant["angular_rate.z"]
        seen = (delta - P.wheelbase * r / v) / plant["acceleration.y"]
        assert seen == pytest.approx(understeer_gradient(P), rel=0.03)
        assert plant["acceleration.y"] == pytest.approx(r * v, rel=1e-4)


def test_load_transfer(car: Make) -> None:
    """Moments about the ground, once the loads have followed."""
    plant = car({"initial.speed": 20.0}, {"command.steer_angle": 0.02, **wheels("wheel_torque", *[200.0] * 4)})
    run(plant, 3.0)
    fl, fr, rl, rr = (plant[f"tyre_force_z.{w}"] for w in WHEELS)
    assert fl + fr + rl + rr == pytest.approx(P.m * P.g)
    assert CAR.d * (fr + rr - fl - rl) == pytest.approx(P.m * CAR.h * plant["acceleration.y"], rel=5e-3)
    shift = P.l_R * (rl + rr) - P.l_F * (fl + fr)
    assert shift == pytest.approx(P.m * CAR.h * plant["acceleration.x"], rel=5e-3)


def test_wheels_turn_faster_by_the_slip_that_their_force_needs(car: Make) -> None:
    """Settled: R omega/V - 1 = F_x/(c F_z); the motion is the same whatever the stiffness."""
    seen = []
    for stiffness in (10.0, 21.5):
        plant = car(
            {"initial.speed": 20.0, "tyre.slip_stiffness": stiffness}, wheels("wheel_torque", 300, 300, -90, -90)
        )
        run(plant, 1.0)
        for w in WHEELS:
            slip = P.R * plant[f"wheel_speed.{w}"] / plant["velocity.x"] - 1.0
            assert slip == pytest.approx(
                plant[f"tyre_force_x.{w}"] / (stiffness * plant[f"tyre_force_z.{w}"]), rel=1e-3
            )
        seen.append([plant["position.x"], plant["velocity.x"]])
    assert seen[0] == seen[1]


def test_a_lost_motor_gives_nothing_and_its_wheel_shows_it(car: Make) -> None:
    """The same motion as without its torque; its wheel is slowed by rolling resistance only."""
    torque = wheels("wheel_torque", 300, 300, 200, 200)
    lost = car({"initial.speed": 20.0}, torque | {"motor_available.rr": 0.0})
    without = car({"initial.speed": 20.0}, torque | {"wheel_torque.rr": 0.0})
    for plant in (lost, without):
        run(plant, 1.0)
    assert lost.outputs() == without.outputs()
    assert lost["tyre_force_x.rr"] < 0.0 < lost["tyre_force_x.rl"]


FLIPPED = (
    "position.y", "yaw", "velocity.y", "angular_rate.z", "acceleration.y", "specific_force.y",
    "angular_acceleration.z", "sideslip", "steer_angle", "steer_rate", "tyre_force_y", "slip_angle",
    "command.steer_angle", "body_force.y", "body_moment.z",
)  # fmt: skip
SWAPPED = {"fl": "fr", "fr": "fl", "rl": "rr", "rr": "rl"}


def mirrored(values: Values) -> dict[str, float]:
    result = {}
    for name, value in values.items():
        stem, _, last = name.rpartition(".")
        partner = f"{stem}.{SWAPPED[last]}" if last in SWAPPED else name
        result[partner] = -value if name.startswith(FLIPPED) else value
    return result


def test_mirrored_run_is_mirrored(car: Make) -> None:
    def control(t: float) -> dict[str, float]:
        return {
            **wheels("wheel_torque", 200 + 90 * math.sin(t), 100, 50, 300),
            **wheels("brake_torque", 0, 10, 30, 0),
            **wheels("road_friction", 0.6, 1.0, 0.9, 1.0),
            "command.steer_angle": 0.05 * math.sin(1.5 * t),
            "body_force.y": 300 * math.sin(t),
            "body_moment.z": 200 * math.cos(t),
        }

    one, other = car({"initial.speed": 25.0}), car({"initial.speed": 25.0})
    run(one, 4.0, control)
    run(other, 4.0, lambda t: mirrored(control(t)))
    assert abs(one["position.y"]) > 1.0
    assert mirrored(one.outputs()) == pytest.approx(other.outputs(), abs=1e-9)


def test_road_friction_limits_the_force_and_keeps_the_stiffness(car: Make) -> None:
    def front(road: float, steer: float) -> float:
        start = {"initial.speed": 20.0, "steering.rate_limit": 100.0, "load.lag": 10.0, "body.inertia.z": 1e5}
        plant = car(start, {"command.steer_angle": steer, **wheels("road_friction", *[road] * 4)})
        run(plant, 0.15)
        return plant["tyre_force_y.fl"] + plant["tyre_force_y.fr"]

    assert front(0.4, 1e-3) == pytest.approx(front(1.0, 1e-3), rel=0.01)
    # a road of 0.4 at a slip of 0.4 has 0.4 of the force of a road of 1 at a slip of 1
    Ba, E = P.front.B, P.front.E
    steady = math.sin(P.front.C * math.atan(Ba - E * (Ba - math.atan(Ba))))
    assert front(0.4, 0.4) == pytest.approx(0.4 * P.front.D * steady, rel=0.01)


@pytest.mark.parametrize("brake", [0.0, 500.0])
def test_standing_car_stays(car: Make, brake: float) -> None:
    """Steered, and with less torque than holds: nothing moves, and brakes give nothing away."""
    drive = brake / 4 + 0.3 * 9e-3 * P.m * P.g * P.R / 4
    plant = car(None, {**wheels("wheel_torque", *[drive] * 4), **wheels("brake_torque", *[brake] * 4)})
    run(plant, 3.0, lambda t: {"command.steer_angle": 0.3})
    assert plant["steer_angle.fl"] == pytest.approx(0.3)
    for name in ("position.x", "position.y", "yaw", "velocity.x", "velocity.y", "angular_rate.z", "sideslip"):
        assert abs(plant[name]) < 1e-9, name
    assert sum(plant[f"tyre_force_x.{w}"] for w in WHEELS) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(("speed", "steer"), [(18.0, 0.02), (-10.0, 0.05), (35.0, 0.2)])
def test_braking_in_a_turn_ends_at_rest(car: Make, speed: float, steer: float) -> None:
    """The last one spins, and comes to rest as well."""
    plant = car({"initial.speed": speed}, {**wheels("brake_torque", *[400.0] * 4), "command.steer_angle": steer})
    slowest, spins = math.inf, steer > 0.1
    for _ in range(1500):
        plant.advance(0.01)
        assert all(math.isfinite(value) for value in plant.outputs().values())
        slowest = min(slowest, plant["velocity.x"] * math.copysign(1.0, speed))
    assert spins or slowest > -1e-6, "the brakes reversed the car"
    assert math.hypot(plant["velocity.x"], plant["velocity.y"]) < 1e-6
    assert abs(plant["angular_rate.z"]) < 1e-6


def test_combined_slip_ends_the_force_at_the_grip(car: Make) -> None:
    brakes = wheels("brake_torque", *[5000.0] * 4)
    free, bound = (car({"initial.speed": 20.0, "tyre.combined_slip": on}, brakes) for on in (False, True))
    for plant in (free, bound):
        run(plant, 0.3)
    assert bound["acceleration.x"] == pytest.approx(-P.g, rel=0.05)
    assert free["acceleration.x"] == pytest.approx(-4 * 5000 / P.R / P.m, rel=0.02)


def test_halving_the_step_shows_order_four(kernel: Kernel) -> None:
    ends = []
    for h in (4e-3, 2e-3, 1e-3, 5e-4):
        made = Direct(
            COMPONENT,
            {"initial.speed": 25.0, "steering.rate_limit": 100.0},
            {**wheels("wheel_torque", 100, 150, 200, 250), "command.steer_angle": 0.03},
            kernel=kernel,
        )
        for _ in range(round(0.4 / h)):
            made.x = kernel.step(made.p, made.d, made.u, made.x, h).full().ravel()
        ends.append(made.x)
    differences = [np.linalg.norm(b - a) for a, b in pairwise(ends)]
    orders = np.log2(np.array(differences[:-1]) / differences[1:])
    assert orders == pytest.approx([4.0, 4.0], abs=0.4)
