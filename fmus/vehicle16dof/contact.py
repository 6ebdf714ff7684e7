"""Where a wheel touches the level road below it, how fast it slides there, and the normal force."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals


@dataclass(frozen=True, slots=True)
class Contact:
    """Directions and arm in K1, forces [N], velocities [m/s], R_e [m], deflection [m]."""

    x: ca.SX
    y: ca.SX
    upright: ca.SX  # from the contact point to the wheel centre
    arm: ca.SX  # from the wheel centre to the contact point
    F_z: ca.SX
    V_x: ca.SX  # of the wheel centre along the track
    V_y: ca.SX  # of the carrier at the contact point, across the track
    V_n: ca.SX  # of the carrier at the contact point, away from the road
    R_e: ca.SX
    delta: ca.SX
    spring: ca.SX  # part of F_z that is stored


def contact(p: Signals, n: ca.SX, s: ca.SX, *, height: ca.SX, v: ca.SX, omega: ca.SX) -> Contact:
    """The contact of a wheel with axle s whose centre is `height` above a road of normal n (all in K1).

    v, omega: velocity of the centre and angular velocity of the knuckle. With the camber component n.s = sin(gamma),
    |s x n| = |n - (n.s) s| = cos(gamma), so directions need one square root; it is kept from zero
    for a car on its side. In the air the contact is the lowest point of the tyre, without force.
    Of the force of the road the part along the radius compresses the tyre: F_z cos(gamma) = c_z delta.
    """
    tilt = ca.dot(n, s)
    inverse = 1 / ca.sqrt(ca.fmax(1 - tilt * tilt, 1e-2))
    x, y = ca.cross(s, n) * inverse, (s - tilt * n) * inverse
    upright = (n - tilt * s) * inverse
    r = ca.fmin(height * inverse, p["wheel.radius"])
    arm = -r * upright
    velocity = v + ca.cross(omega, arm)
    delta, V_n = p["wheel.radius"] - r, ca.dot(velocity, n)
    spring = p["tyre.vertical_stiffness"] * delta * inverse
    F_z = ca.if_else(delta > 0, ca.fmax(spring - p["tyre.vertical_damping"] * V_n, 0), 0)
    R_e = p["wheel.radius"] - delta / 3
    return Contact(x, y, upright, arm, F_z, ca.dot(v, x), ca.dot(velocity, y), V_n, R_e, delta, spring)
