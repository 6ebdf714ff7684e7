"""Rotations of right-handed frames: about one axis, and of a body given by roll, pitch and yaw.

A matrix takes components in the turned frame to components in the frame it was turned from. Angles in rad.
"""

from __future__ import annotations

from typing import Any

import casadi as ca


def rotation_x(angle: Any) -> ca.SX:
    """Rx (3 x 3): y towards z."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(1, 0, 0), ca.horzcat(0, c, -s), ca.horzcat(0, s, c))


def rotation_y(angle: Any) -> ca.SX:
    """Ry (3 x 3): z towards x."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, 0, s), ca.horzcat(0, 1, 0), ca.horzcat(-s, 0, c))


def rotation_z(angle: Any) -> ca.SX:
    """Rz (3 x 3): x towards y."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s, 0), ca.horzcat(s, c, 0), ca.horzcat(0, 0, 1))


def rotation_plane(angle: Any) -> Any:
    """Rz in the plane (2 x 2)."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


def wrap(angle: Any) -> Any:
    """The same direction [rad] in [-pi, pi]."""
    return ca.atan2(ca.sin(angle), ca.cos(angle))


def levelling(roll: Any, pitch: Any) -> ca.SX:
    """Ry(pitch) Rx(roll) (3 x 3): body to the level frame, which is yawed with the body only."""
    return rotation_y(pitch) @ rotation_x(roll)


def body_to_world(roll: Any, pitch: Any, yaw: Any) -> ca.SX:
    """R = Rz(yaw) Ry(pitch) Rx(roll) (3 x 3)."""
    return rotation_z(yaw) @ levelling(roll, pitch)


def angles(R: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(roll, pitch, yaw) of R = Rz(yaw) Ry(pitch) Rx(roll): the inverse of `body_to_world` for |pitch| < pi/2."""
    pitch = ca.atan2(-R[2, 0], ca.sqrt(R[2, 1] * R[2, 1] + R[2, 2] * R[2, 2]))
    return ca.atan2(R[2, 1], R[2, 2]), pitch, ca.atan2(R[1, 0], R[0, 0])


def angle_rates(roll: ca.SX, pitch: ca.SX, omega: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX]:
    """(roll', pitch', yaw') from the angular velocity omega (3) in the body frame."""
    across = omega[1] * ca.sin(roll) + omega[2] * ca.cos(roll)
    upward = omega[1] * ca.cos(roll) - omega[2] * ca.sin(roll)
    return omega[0] + ca.tan(pitch) * across, upward, across / ca.cos(pitch)
