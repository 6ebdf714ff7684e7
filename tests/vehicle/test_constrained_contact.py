"""Wheel loads of the tyre springs against those of a car whose wheels are held to the road by constraints.

The constrained car is Pinocchio's tree on rigid wheels of the nominal loaded radius: c, the height of the contact, = 0
at each wheel, with the wheel load as its Lagrange multiplier. At rest and in a steady turn u' = 0, and

    h(q, u) = Q(q) + J_c' lambda,   c(q) = 0

in heave, roll, pitch and the four travels give these seven coordinates and the four loads.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import fsolve
from scipy.spatial.transform import Rotation
from test_handling import steady_turn
from vehicle_car import Car
from vehicle_contact import coordinates, named, road_contact, tyre_wrench
from vehicle_oracle import car_model, pin_equations

from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.vehicle16dof.states import CORNERS

pin = pytest.importorskip("pinocchio")
MakeCar = Callable[..., Car]


def loaded_radius(p: dict[str, float], steered: bool) -> float:
    share = (DESIGN.l_r if steered else DESIGN.l_f) / DESIGN.wheelbase
    return p["wheel.radius"] - share * DESIGN.mass * DESIGN.gravity / 2 / p["tyre.vertical_stiffness"]


def constrained_loads(car: Car, roll: float, pitch: float) -> np.ndarray:
    """The four multipliers [N] for the motion and the horizontal tyre forces of `car`."""
    p, model = named(car), car_model(named(car))
    model.gravity.linear = np.array([0.0, 0.0, -p["gravity"]])
    q_0, u = coordinates(car.x)
    yaw = car["yaw"]
    travel = [model.joints[model.getJointId(f"travel.{c.name}")] for c in CORNERS]

    def placed(s: np.ndarray) -> np.ndarray:
        q = q_0.copy()
        q[2], q[3:7] = s[0], Rotation.from_euler("ZYX", [yaw, s[2], s[1]]).as_quat()
        for joint, t in zip(travel, s[3:7], strict=True):
            q[joint.idx_q] = t
        return q

    def residual(unknown: np.ndarray) -> np.ndarray:
        q, loads = placed(unknown[:7]), 1e3 * unknown[7:]
        heights, Q = forces(car, model, q, u, loads)
        rows = [2, 3, 4, *(joint.idx_v for joint in travel)]
        return np.concatenate([(pin_equations(model, q, u)[1] - Q)[rows] / 1e3, heights * 1e2])

    guess = [car["position.z"], roll, pitch, *(car[f"suspension_travel.{w}"] for w in WHEELS)]
    found, _, ok, message = fsolve(residual, [*guess, 4.0, 4.0, 3.0, 3.0], full_output=True)
    assert ok == 1, message
    return 1e3 * found[7:]


def forces(car: Car, model, q: np.ndarray, u: np.ndarray, loads: np.ndarray) -> tuple[np.ndarray, np.ndarray]:  # type: ignore[no-untyped-def]
    """Heights of the contact points of the rigid wheels and Q (16): tyres, springs and drag."""
    p, data, v = named(car), model.createData(), u[0]
    pin.forwardKinematics(model, data, q, u)
    pin.computeJointJacobians(model, data, q)
    heights, Q = [], np.zeros(model.nv)
    Q[0] -= 0.5 * p["air.density"] * p["body.drag_coefficient"] * p["body.frontal_area"] * v * abs(v)
    travel = [q[model.joints[model.getJointId(f"travel.{c.name}")].idx_q] for c in CORNERS]
    for c in CORNERS:
        wheel, key = model.getJointId(f"wheel.{c.name}"), f"suspension.{c.axle}"
        carrier = model.getJointId(f"steer.{c.name}" if c.steered else f"travel.{c.name}")
        centre = data.oMi[wheel].translation
        touch = road_contact(centre, data.oMi[carrier].rotation[:, 1])
        r = loaded_radius(p, c.steered)
        arm = touch.arm * r / np.linalg.norm(touch.arm)
        heights.append(centre[2] + arm[2])
        moving = pin.getVelocity(model, data, wheel, pin.LOCAL_WORLD_ALIGNED)
        F, N = tyre_wrench(car, c.name, touch, moving.linear, moving.angular)
        F[2] = loads[c.index]
        J = pin.getJointJacobian(model, data, wheel, pin.LOCAL_WORLD_ALIGNED)
        Q += J[:3].T @ F + J[3:].T @ (np.cross(arm, F) + N)
        spring = p[f"{key}.preload"] + p[f"{key}.stiffness"] * travel[c.index]
        spring += p[f"{key}.anti_roll"] * (travel[c.index] - travel[c.opposite])
        Q[model.joints[model.getJointId(f"travel.{c.name}")].idx_v] -= spring
    return np.array(heights), Q


def loads(car: Car) -> np.ndarray:
    return np.array([car[f"tyre_force_z.{w}"] for w in WHEELS])


# Soft tyres belong to the roll stiffness, so the two split the lateral load transfer differently: by up to 1.3 %
# of a wheel load at 3 m/s2. The difference is that alone: on tyres five times as stiff it is a quarter.
STIFFNESS = pytest.mark.parametrize(("stiffness", "tolerance"), [(200e3, 0.015), (1000e3, 0.004)])


@STIFFNESS
@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.2, 0.0, 0.1), (-0.2, 0.1, 0.0), (0.1, -0.1, 0.1)])
def test_at_rest(car: MakeCar, offset: tuple[float, float, float], stiffness: float, tolerance: float) -> None:
    shift = {f"cog_offset.{a}": value for a, value in zip("xyz", offset, strict=True)}
    made = car({**shift, "tyre.vertical_stiffness": stiffness})
    assert constrained_loads(made, made["roll"], made["pitch"]) == pytest.approx(loads(made), rel=tolerance)


@STIFFNESS
def test_in_a_steady_turn(car: MakeCar, stiffness: float, tolerance: float) -> None:
    made = car({"initial.speed": 20.0, "tyre.vertical_stiffness": stiffness})
    steady_turn(made, 20.0, 3.0)
    assert abs(made["acceleration.y"]) > 2.9
    assert constrained_loads(made, made["roll"], made["pitch"]) == pytest.approx(loads(made), rel=tolerance)


def test_gentle_turn_within_a_percent(car: MakeCar) -> None:
    made = car({"initial.speed": 20.0})
    steady_turn(made, 20.0, 2.0)
    assert constrained_loads(made, made["roll"], made["pitch"]) == pytest.approx(loads(made), rel=0.01)
