"""Conservation laws in free flight, and the power of every force on the ground."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from vehicle_car import SLICES, Car
from vehicle_contact import coordinates, joint_order, named, road_contact, tyre_wrench
from vehicle_oracle import car_model, pin_equations

from fmus.cars.wheels import WHEELS
from fmus.vehicle16dof import COMPONENT
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import CORNERS

pin = pytest.importorskip("pinocchio")
MakeCar = Callable[..., Car]
LOSSLESS = {
    "suspension.front.damping": 0.0,
    "suspension.rear.damping": 0.0,
    "steering.damping": 0.0,
    "body.drag_coefficient": 0.0,
    "suspension.travel": 1.0,  # no stops: they are elastic too, but their corners cost integration order
    "steering.stop_stiffness": 0.0,
}
HEIGHT = 100.0
DERIVATIVE = COMPONENT.kernel().derivative


def model_of(car: Car) -> pin.Model:
    return car_model(named(car))


def throw(car: Car, rng: np.random.Generator) -> None:
    """A tumbling car high above the ground, wheels spinning, suspensions swinging."""
    car.x[SLICES["position"]][2] += HEIGHT
    for name, size in (("velocity", 5.0), ("angular_rate", 1.0), ("travel_rate", 0.2), ("steer_rate", 0.5)):
        car.x[SLICES[name]] = rng.normal(size=car.x[SLICES[name]].size) * size
    car.x[SLICES["wheel_speed"]] = rng.uniform(50, 100, 4)


def energy(car: Car, model: pin.Model) -> float:
    q, u = coordinates(car.x)
    data, p = model.createData(), named(car)
    model.gravity.linear = np.array([0, 0, -p["gravity"]])
    total = pin.computeKineticEnergy(model, data, q, u) + pin.computePotentialEnergy(model, data, q)
    travel = car.x[SLICES["travel"]]
    for c in CORNERS:
        key, t = f"suspension.{c.axle}", travel[c.index]
        total += p[f"{key}.preload"] * t + 0.5 * p[f"{key}.stiffness"] * t**2
        total += 0.25 * p[f"{key}.anti_roll"] * (t - travel[c.opposite]) ** 2
        over = max(abs(t) - p["suspension.travel"], 0.0)
        total += 0.5 * p["suspension.stop_stiffness"] * over**2
    return float(total)


@pytest.mark.parametrize("gravity", [0.0, 9.81])
def test_energy_and_momentum_in_free_flight(car: MakeCar, gravity: float) -> None:
    made = car({**LOSSLESS, "gravity": 9.81, "cog_offset.y": 0.1, "body.inertia.xz": 50.0})
    made.p[INTERFACE.names("parameter").index("gravity")] = gravity
    throw(made, np.random.default_rng(5))
    model = model_of(made)

    def momentum() -> np.ndarray:
        q, u = coordinates(made.x)
        return pin.computeCentroidalMomentum(model, model.createData(), q, u).vector

    e_0, h_0 = energy(made, model), momentum()
    made.run(1.0, h=1e-4)
    assert energy(made, model) == pytest.approx(e_0, rel=1e-9)
    fallen = np.array([0, 0, -gravity * 1.0 * pin.computeTotalMass(model), 0, 0, 0])
    assert momentum() == pytest.approx(h_0 + fallen, rel=1e-8, abs=1e-6 * np.abs(h_0).max())


def test_virtual_power_of_every_force(car: MakeCar) -> None:
    """M u' + h of Pinocchio equals the generalised forces of tyres, springs and actuators, joint by joint."""
    rng = np.random.default_rng(6)
    limits = {"gravity": 9.81, "tyre.low_speed.speed": 0.1}
    load = {"cog_offset.x": 0.1, "payload.mass": 150.0, "payload.y": 0.4}
    for _ in range(20):
        made = car({**limits, **load, "initial.speed": 15.0, "initial.yaw": rng.uniform(-3, 3)})
        disturb(made, rng)
        y = made.kernel.output(made.p, made.d, made.u, made.x).full().ravel()
        made.y = y
        model, (q, u) = model_of(made), coordinates(made.x)
        M, h = pin_equations(model, q, u)
        left, right = M @ accelerations(made) + h, generalised_forces(made, model, q, u)
        assert left == pytest.approx(right, rel=1e-9, abs=1e-9 * np.abs(h).max())
        assert u @ left == pytest.approx(u @ right, rel=1e-9)


def disturb(car: Car, rng: np.random.Generator) -> None:
    for name, size in (
        ("angular_rate", 0.3),
        ("travel", 0.02),
        ("travel_rate", 0.2),
        ("steer", 0.1),
        ("steer_rate", 0.3),
    ):
        car.x[SLICES[name]] += rng.normal(size=car.x[SLICES[name]].size) * size
    car.x[SLICES["slip_ratio"]] = rng.normal(size=4) * 0.05
    car.x[SLICES["slip_tangent"]] = rng.normal(size=4) * 0.05
    for name in ("wheel_torque", "suspension_force", "steer_torque"):
        for wheel in WHEELS if name != "steer_torque" else WHEELS[:2]:
            car.set({f"{name}.{wheel}": rng.normal() * 200})
    car.set({f"brake_torque.{wheel}": rng.uniform(0, 300) for wheel in WHEELS})
    car.set({f"body_{kind}.{a}": rng.normal() * 500 for kind in ("force", "moment") for a in "xyz"})


def accelerations(car: Car) -> np.ndarray:
    """u' of the plant."""
    rate = DERIVATIVE(car.p, car.d, car.u, car.x).full().ravel()
    s = {name: rate[where] for name, where in SLICES.items()}
    return np.concatenate(
        [s["velocity"], s["angular_rate"], joint_order(s["travel_rate"], s["steer_rate"], s["wheel_speed"])]
    )


def generalised_forces(car: Car, model: pin.Model, q: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Jacobians of the contact points times the forces seen at the outputs, plus joint forces and body loads."""
    p, data = named(car), model.createData()
    pin.forwardKinematics(model, data, q, u)
    inputs = dict(zip(INTERFACE.names("input"), car.u, strict=True))
    pin.computeJointJacobians(model, data, q)
    v = car.x[SLICES["velocity"]]
    drag = 0.5 * p["air.density"] * p["body.drag_coefficient"] * p["body.frontal_area"] * v[0] * abs(v[0])
    total = np.zeros(16)
    total[:6] = [inputs[f"body_{kind}.{a}"] for kind in ("force", "moment") for a in "xyz"]
    total[0] -= drag
    travel, rate = car.x[SLICES["travel"]], car.x[SLICES["travel_rate"]]
    for c in CORNERS:
        joint = model.getJointId(f"wheel.{c.name}")
        place = data.oMi[joint]
        carrier = model.getJointId(f"steer.{c.name}" if c.steered else f"travel.{c.name}")
        moving = pin.getVelocity(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        touch = road_contact(place.translation, data.oMi[carrier].rotation[:, 1])
        J = pin.getJointJacobian(model, data, joint, pin.LOCAL_WORLD_ALIGNED)
        F, N = tyre_wrench(car, c.name, touch, moving.linear, moving.angular)
        total += J[:3].T @ F + J[3:].T @ (np.cross(touch.arm, F) + N)
        total[model.joints[joint].idx_v] += inputs[f"wheel_torque.{c.name}"] - inputs[f"brake_torque.{c.name}"]
        key, t = f"suspension.{c.axle}", travel[c.index]
        spring = p[f"{key}.preload"] + p[f"{key}.stiffness"] * t + p[f"{key}.damping"] * rate[c.index]
        over = max(abs(t) - p["suspension.travel"], 0.0) * np.sign(t) * p["suspension.stop_stiffness"]
        spring += p[f"{key}.anti_roll"] * (t - travel[c.opposite]) + inputs[f"suspension_force.{c.name}"] + over
        total[model.joints[model.getJointId(f"travel.{c.name}")].idx_v] -= spring
        if c.steered:
            damping = p["steering.damping"] * car.x[SLICES["steer_rate"]][c.index]
            steer = model.joints[model.getJointId(f"steer.{c.name}")].idx_v
            total[steer] += inputs[f"steer_torque.{c.name}"] - damping
    return total
