"""The equations of motion against Pinocchio, and the eliminated solve against the Gibbs-Appell form."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from vehicle_oracle import car_model, inertia, pin_equations, rotation, start_model

from fmukit.kernel import Signals, block, slots
from fmus.vehicle16dof.dynamics import Leg, accelerations
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.masses import masses
from fmus.vehicle16dof.states import CORNERS, wheel_place
from tests.references import appell, tree

pin = pytest.importorskip("pinocchio")
SAMPLES = 1000


def positive(rng: np.random.Generator, size: float) -> np.ndarray:
    A = rng.normal(size=(3, 3))
    return size * (A @ A.T + 0.1 * np.eye(3))


def random_attitude(rng: np.random.Generator) -> np.ndarray:
    q = rng.normal(size=4)
    return q / np.linalg.norm(q)  # pinocchio: x, y, z, w


ANTECEDENTS = (0, 1, 2, 0, 4, 0, 6, 6, 8, 9)
PRISMATIC = (1, 0, 0, 1, 0, 0, 1, 0, 0, 1)


@pytest.fixture(scope="module")
def general() -> ca.Function:
    """M, h of a tree of eleven bodies with free DH rows (gamma, b, alpha, d, theta, r), masses and inertias."""
    rows, m, rho, J = ca.SX.sym("rows", 6, 10), ca.SX.sym("m", 11), ca.SX.sym("rho", 3, 11), ca.SX.sym("J", 3, 33)
    q, u, g = ca.SX.sym("q", 10), ca.SX.sym("u", 16), ca.SX.sym("g", 3)
    joints = [
        tree.Joint(str(j), a, bool(s), *ca.vertsplit(rows[:, j]))
        for j, (a, s) in enumerate(zip(ANTECEDENTS, PRISMATIC, strict=True))
    ]
    bodies = [tree.Body(m[i], rho[:, i], J[:, 3 * i : 3 * i + 3]) for i in range(11)]
    return ca.Function("general", [rows, m, rho, J, q, u, g], appell.mass_and_bias(joints, bodies, q, u, g))


def test_gibbs_form_of_random_trees_equals_pinocchio(general: ca.Function) -> None:
    rng = np.random.default_rng(1)
    worst = 0.0
    for _ in range(SAMPLES):
        rows, m = rng.uniform(-2, 2, (6, 10)), rng.uniform(0.5, 50, 11)
        rho = rng.normal(size=(3, 11)) * m
        J = [positive(rng, k) + k * (r @ r * np.eye(3) - np.outer(r, r)) for k, r in zip(m, (rho / m).T, strict=True)]
        q, u, attitude = rng.normal(size=10), rng.normal(size=16), random_attitude(rng)
        model = start_model(inertia(m[0], rho[:, 0], J[0]))
        for j in range(10):
            joint = pin.JointModelPZ() if PRISMATIC[j] else pin.JointModelRZ()
            gamma, b, alpha, d, theta, r = rows[:, j]
            place = (
                pin.SE3(pin.utils.rotate("z", gamma), np.array([0, 0, b]))
                * pin.SE3(pin.utils.rotate("x", alpha), np.zeros(3))
                * pin.SE3(np.eye(3), np.array([d, 0, 0]))
                * pin.SE3(pin.utils.rotate("z", theta), np.array([0, 0, r]))
            )
            index = model.addJoint(ANTECEDENTS[j] + 1, joint, place, str(j))
            model.appendBodyToJoint(index, inertia(m[j + 1], rho[:, j + 1], J[j + 1]), pin.SE3.Identity())
        M, h = general(rows, m, rho, np.hstack(J), q, u, rotation(attitude).T @ [0, 0, -9.81])
        M_pin, h_pin = pin_equations(model, np.concatenate([np.zeros(3), attitude, q]), u)
        worst = max(worst, relative(M.full(), M_pin), relative(h.full().ravel(), h_pin))
    assert worst < 1e-10


def relative(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.abs(a - b).max() / np.abs(b).max())


VARIED = ("body.", "geometry.", "knuckle.", "wheel.", "cog_offset.", "payload.")


def random_parameters(rng: np.random.Generator) -> np.ndarray:
    """Plausible cars: masses, inertias and geometry within +-40 %, offsets and payload anywhere small."""
    values = []
    for v in INTERFACE.select("parameter"):
        start = float(v.start)
        varied = v.name.startswith(VARIED)
        values.append(start * rng.uniform(0.6, 1.4) if varied else start)
        if varied and start == 0.0:
            values[-1] = rng.uniform(0, 300) if v.name == "payload.mass" else rng.uniform(-0.3, 0.3)
    return np.array(values)


@pytest.fixture(scope="module")
def car_equations() -> ca.Function:
    """(p, q, u, Q, g) -> M, h of the reference, and u' of the eliminated solve."""
    return _car_equations.function


@block(p=slots(INTERFACE, "parameter"), q=10, u=16, Q=16, g=3)
def _car_equations(p: Signals, q: ca.SX, u: ca.SX, Q: ca.SX, g: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    d = masses(p)
    M, h = appell.mass_and_bias(tree.joints(p), tree.bodies(p, d), q, u, g)
    legs, first = [], 0
    for corner in CORNERS:
        i, steered = 6 + first, corner.steered
        delta, turn, steer = (q[first + 1], u[i + 1], Q[i + 1]) if steered else (ca.SX(0),) * 3
        place = ca.vertcat(*wheel_place(p, corner)) + ca.vertcat(0, 0, q[first])
        last = 2 if steered else 1
        legs.append(
            Leg(
                place,
                u[i],
                ca.sin(delta),
                ca.cos(delta),
                turn,
                u[i + last],
                steered,
                Q_travel=Q[i],
                Q_steer=steer,
                Q_spin=Q[i + last],
            )
        )
        first += last + 1
    a = accelerations(p, d, u[3:6], legs, force=Q[:3], moment=Q[3:6])
    front = [ca.vertcat(a.travel[i], a.steer[i], a.spin[i]) for i in (0, 1)]
    rear = [ca.vertcat(a.travel[i], a.spin[i]) for i in (2, 3)]
    rate = ca.vertcat(a.specific_force + g - ca.cross(u[3:6], u[:3]), a.angular, *front, *rear)
    return M, h, rate


def test_car_equals_pinocchio_and_the_eliminated_solve_equals_both(car_equations: ca.Function) -> None:
    rng = np.random.default_rng(2)
    names = INTERFACE.names("parameter")
    worst = {"M": 0.0, "h": 0.0, "residual": 0.0}
    for _ in range(SAMPLES):
        p, attitude = random_parameters(rng), random_attitude(rng)
        q, u = rng.uniform(-0.5, 0.5, 10), rng.normal(size=16) * 3
        Q = rng.normal(size=16) * 1000
        M, h, rate = (x.full() for x in car_equations(p, q, u, Q, rotation(attitude).T @ [0, 0, -9.81]))
        model = car_model(dict(zip(names, p, strict=True)))
        M_pin, h_pin = pin_equations(model, np.concatenate([np.zeros(3), attitude, q]), u)
        worst["M"] = max(worst["M"], relative(M, M_pin))
        worst["h"] = max(worst["h"], relative(h.ravel(), h_pin))
        force = M_pin @ rate.ravel() + h_pin
        worst["residual"] = max(worst["residual"], float(np.abs(force - Q).max() / np.abs(h_pin).max()))
    assert max(worst.values()) < 1e-10, worst
