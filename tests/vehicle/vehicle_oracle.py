"""The car as a Pinocchio tree, an independent statement of its equations of motion."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.vehicle16dof.states import CORNERS, Corner

pin = pytest.importorskip("pinocchio")


def inertia(mass: float, moment: np.ndarray, about_origin: np.ndarray) -> pin.Inertia:
    c = moment / mass if mass else np.zeros(3)
    return pin.Inertia(mass, c, about_origin - mass * (c @ c * np.eye(3) - np.outer(c, c)))


def pin_equations(model: pin.Model, q: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    data = model.createData()
    M = pin.crba(model, data, q)
    return np.triu(M) + np.triu(M, 1).T, pin.nonLinearEffects(model, data, q, u)


def start_model(body: pin.Inertia) -> pin.Model:
    model = pin.Model()
    base = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), "base")
    model.appendBodyToJoint(base, body, pin.SE3.Identity())
    return model


def rotation(q: np.ndarray) -> np.ndarray:
    return pin.Quaternion(q[3], *q[:3]).toRotationMatrix()


def wheel_centre(p: dict[str, float], corner: Corner) -> np.ndarray:
    x = p["geometry.front_axle"] if corner.steered else -p["geometry.rear_axle"]
    return np.array([x, corner.side * p[f"geometry.track_{corner.axle}"] / 2, -p[f"geometry.wheel_drop_{corner.axle}"]])


def sprung_centre(p: dict[str, float]) -> np.ndarray:
    """Centre of gravity of the sprung body once the centre of the whole car has moved by cog_offset.

    From the first moments: what the whole car should have, less what the unmoved wheels and knuckles have.
    """
    nominal, offset = (np.array([p[f"{n}.{a}"] for a in "xyz"]) for n in ("body.cog", "cog_offset"))
    m_u = p["knuckle.mass"] + p["wheel.mass"]
    unsprung = m_u * sum(wheel_centre(p, corner) for corner in CORNERS)
    whole = p["body.mass"] + 4 * m_u
    before = (p["body.mass"] * nominal + unsprung) / whole
    return (whole * (before + offset) - unsprung) / p["body.mass"]


def chassis(p: dict[str, float]) -> tuple[pin.Inertia, pin.Inertia]:
    """Sprung body and payload, each about its own centre; Pinocchio adds them."""
    xz = p["body.inertia.xz"]
    I_c = np.diag([p[f"body.inertia.{a}"] for a in "xyz"]) + xz * np.array([[0, 0, 1], [0, 0, 0], [1, 0, 0]])
    place = np.array([p[f"payload.{a}"] for a in "xyz"])
    return pin.Inertia(p["body.mass"], sprung_centre(p), I_c), pin.Inertia(p["payload.mass"], place, np.zeros((3, 3)))


def car_model(p: dict[str, float]) -> pin.Model:
    """The car as a Pinocchio tree, from its parameters alone: no DH table, no mass properties of the plant."""
    body, payload = chassis(p)
    model = start_model(body)
    model.appendBodyToJoint(1, payload, pin.SE3.Identity())
    knuckle = pin.Inertia(p["knuckle.mass"], np.zeros(3), np.diag([p[f"knuckle.inertia.{a}"] for a in "xyz"]))
    across, spin = p["wheel.inertia.diametral"], p["wheel.inertia.spin"]
    wheel = pin.Inertia(p["wheel.mass"], np.zeros(3), np.diag([across, spin, across]))
    for corner in CORNERS:
        place = pin.SE3(np.eye(3), wheel_centre(p, corner))
        joint = model.addJoint(1, pin.JointModelPZ(), place, f"travel.{corner.name}")
        if corner.steered:
            joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3.Identity(), f"steer.{corner.name}")
        model.appendBodyToJoint(joint, knuckle, pin.SE3.Identity())
        joint = model.addJoint(joint, pin.JointModelRY(), pin.SE3.Identity(), f"wheel.{corner.name}")
        model.appendBodyToJoint(joint, wheel, pin.SE3.Identity())
    return model
