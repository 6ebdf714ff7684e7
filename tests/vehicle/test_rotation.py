"""The rotation matrices against scipy's, and the rates of the angles against finite differences."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from fmus.cars import rotation
from fmus.vehicle16dof import attitude

ROLL, PITCH, YAW = 0.3, -0.7, 2.4


def numbers(value: ca.SX) -> np.ndarray:
    return ca.DM(value).full()


@pytest.mark.parametrize("axis", "xyz")
def test_elementary_rotations(axis: str) -> None:
    made = numbers(getattr(rotation, f"rotation_{axis}")(YAW))
    np.testing.assert_allclose(made, Rotation.from_euler(axis, YAW).as_matrix(), atol=1e-15)


def test_body_to_world_and_back() -> None:
    R = rotation.body_to_world(ROLL, PITCH, YAW)
    expected = Rotation.from_euler("ZYX", [YAW, PITCH, ROLL])
    np.testing.assert_allclose(numbers(R), expected.as_matrix(), atol=1e-15)
    assert [float(ca.DM(a)) for a in rotation.angles(R)] == pytest.approx([ROLL, PITCH, YAW])
    w, *vector = numbers(attitude.from_angles(ROLL, PITCH, YAW)).ravel()
    np.testing.assert_allclose(Rotation.from_quat([*vector, w]).as_matrix(), expected.as_matrix(), atol=1e-15)


def test_angle_rates_are_those_of_a_spinning_body() -> None:
    omega, h = np.array([0.4, -0.9, 1.3]), 1e-6
    start = Rotation.from_euler("ZYX", [YAW, PITCH, ROLL])
    ahead, behind = ((start * Rotation.from_rotvec(s * h * omega)).as_euler("ZYX")[::-1] for s in (1, -1))
    rates = [float(ca.DM(r)) for r in rotation.angle_rates(ca.SX(ROLL), ca.SX(PITCH), ca.SX(omega))]
    np.testing.assert_allclose(rates, (ahead - behind) / (2 * h), atol=1e-8)
