"""Attitude as a unit quaternion (w, x, y, z), body to world: the form in which the car is integrated."""

from __future__ import annotations

import casadi as ca


def rotation(attitude: ca.SX) -> ca.SX:
    """R (3x3), body to world."""
    w, x, y, z = ca.vertsplit(attitude)
    return ca.vertcat(
        ca.horzcat(1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        ca.horzcat(2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        ca.horzcat(2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def rate(attitude: ca.SX, omega: ca.SX) -> ca.SX:
    """Time derivative for the angular velocity omega in the body frame."""
    w, vector = attitude[0], attitude[1:]
    return 0.5 * ca.vertcat(-ca.dot(vector, omega), w * omega + ca.cross(vector, omega))


def from_angles(roll: ca.SX, pitch: ca.SX, yaw: ca.SX) -> ca.SX:
    """The quaternion of `fmus.cars.rotation.body_to_world(roll, pitch, yaw)`."""
    (c_r, s_r), (c_p, s_p), (c_y, s_y) = ((ca.cos(a / 2), ca.sin(a / 2)) for a in (roll, pitch, yaw))
    return ca.vertcat(
        c_r * c_p * c_y + s_r * s_p * s_y,
        s_r * c_p * c_y - c_r * s_p * s_y,
        c_r * s_p * c_y + s_r * c_p * s_y,
        c_r * c_p * s_y - s_r * s_p * c_y,
    )
