"""The hand point of a vehicle, a ahead of O1 on the body x axis: through it a car can be moved in any direction.

A vehicle that cannot slide sideways has no force across itself, but its hand moves across by turning:
h = p + a e(psi), h' = R(psi) (v_x, v_y + a omega). Frames and signs: world x east, y north, yaw counter-clockwise.
"""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

Symbol = TypeVar("Symbol", ca.SX, ca.MX, ca.DM)

S = ca.DM([[0.0, -1.0], [1.0, 0.0]])
"""S x is x turned by a quarter to the left; R' = psi' R S."""


def rotation(yaw: Symbol) -> Symbol:
    """R(yaw) (2 x 2): body to world in the plane."""
    c, s = ca.cos(yaw), ca.sin(yaw)
    return ca.vertcat(ca.horzcat(c, -s), ca.horzcat(s, c))


def wrap(angle: Symbol) -> Symbol:
    """The angle [rad] in [-pi, pi]."""
    return ca.atan2(ca.sin(angle), ca.cos(angle))


def point(position: Symbol, yaw: Symbol, a: Symbol | float) -> Symbol:
    """h = p + a e(psi) [m] (2) from the position of O1 (2) and the yaw angle."""
    return position + a * ca.vertcat(ca.cos(yaw), ca.sin(yaw))


def body_velocity(velocity: Symbol, yaw_rate: Symbol, a: Symbol | float) -> Symbol:
    """Velocity of the hand in body axes [m/s] (2): (v_x, v_y + a omega), velocity of O1 in body axes."""
    return ca.vertcat(velocity[0], velocity[1] + a * yaw_rate)


def velocity(velocity: Symbol, yaw: Symbol, yaw_rate: Symbol, a: Symbol | float) -> Symbol:
    """h' in world axes [m/s] (2); `velocity` is that of O1 in body axes, sideslip included."""
    return rotation(yaw) @ body_velocity(velocity, yaw_rate, a)
