"""The hand point of a vehicle, a ahead of O1 on the body x axis: through it a car can be moved in any direction.

A vehicle that cannot slide sideways has no force across itself, but its hand moves across by turning:
h = p + a e(psi), h' = R(psi) (v_x, v_y + a omega). Frames and signs: world x east, y north, yaw counter-clockwise.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmus.cars.rotation import rotation_plane
from fmus.controllers.formation.moving import MovingPlace

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


def moving(vehicle: MovingPlace, a: Any) -> MovingPlace:
    """h, h', h'' in world axes (2 each) of a vehicle that moves as (x, y, psi) of its O1 does."""
    turning, turning_rate = vehicle.rate[2], vehicle.acceleration[2]
    e = ca.vertcat(ca.cos(vehicle.place[2]), ca.sin(vehicle.place[2]))
    return MovingPlace(
        vehicle.place[:2] + a * e,
        vehicle.rate[:2] + a * turning * S @ e,
        vehicle.acceleration[:2] + a * (turning_rate * S @ e - turning**2 * e),
    )
