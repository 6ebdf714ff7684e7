"""The hand point of a vehicle, a ahead of O1 on the body x axis: through it a car can be moved in any direction.

A vehicle that cannot slide sideways has no force across itself, but its hand moves across by turning:
h = p + a e(psi), h' = R(psi) (v_x, v_y + a omega). Frames and signs: world x east, y north, yaw counter-clockwise.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmus.cars.rotation import rotation_plane

S = ca.DM([[0.0, -1.0], [1.0, 0.0]])
"""S x is x turned by a quarter to the left; R' = psi' R S."""


def point(position: Any, yaw: Any, a: Any) -> Any:
    """h = p + a e(psi) [m] (2) from the position of O1 (2) and the yaw angle."""
    return position + a * ca.vertcat(ca.cos(yaw), ca.sin(yaw))


def body_velocity(velocity: Any, yaw_rate: Any, a: Any) -> Any:
    """Velocity of the hand in body axes [m/s] (2): (v_x, v_y + a omega), velocity of O1 in body axes."""
    return ca.vertcat(velocity[0], velocity[1] + a * yaw_rate)


def velocity(velocity: Any, yaw: Any, yaw_rate: Any, a: Any) -> Any:
    """h' in world axes [m/s] (2); `velocity` is that of O1 in body axes, sideslip included."""
    return rotation_plane(yaw) @ body_velocity(velocity, yaw_rate, a)
