"""The car as a Pinocchio tree, an independent statement of its equations of motion."""

from __future__ import annotations

import numpy as np
import pytest

from fmus.vehicle16dof.states import CORNERS

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


def car_model(p: dict[str, float], d: dict[str, np.ndarray]) -> pin.Model:
    """The car as a Pinocchio tree, from its geometry, without the DH table."""
    xx, yy, zz, xy, xz, yz = d["inertia"]
    J = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    model = start_model(inertia(d["mass"][0], d["mass_moment"], J))
    knuckle = pin.Inertia(p["knuckle.mass"], np.zeros(3), np.diag([p[f"knuckle.inertia.{a}"] for a in "xyz"]))
    across, spin = p["wheel.inertia.diametral"], p["wheel.inertia.spin"]
    wheel = pin.Inertia(p["wheel.mass"], np.zeros(3), np.diag([across, spin, across]))
    for corner in CORNERS:
        x = p["geometry.front_axle"] if corner.steered else -p["geometry.rear_axle"]
        y = corner.side * p[f"geometry.track_{corner.axle}"] / 2
        place = pin.SE3(np.eye(3), np.array([x, y, -p[f"geometry.wheel_drop_{corner.axle}"]]))
        joint = model.addJoint(1, pin.JointModelPZ(), place, f"travel.{corner.name}")
        if corner.steered:
            joint = model.addJoint(joint, pin.JointModelRZ(), pin.SE3.Identity(), f"steer.{corner.name}")
        model.appendBodyToJoint(joint, knuckle, pin.SE3.Identity())
        joint = model.addJoint(joint, pin.JointModelRY(), pin.SE3.Identity(), f"wheel.{corner.name}")
        model.appendBodyToJoint(joint, wheel, pin.SE3.Identity())
    return model
