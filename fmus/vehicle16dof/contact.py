"""Where a wheel touches the level road below it, how fast it slides there, and the normal force."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals


@dataclass(frozen=True, slots=True)
class Contact:
    """Directions and arm in K1, F_z [N], sliding velocities of the carrier at the contact [m/s], R_e [m]."""

    x: ca.SX
    y: ca.SX
    arm: ca.SX  # from the wheel centre to the contact point
    F_z: ca.SX
    V_x: ca.SX
    V_y: ca.SX
    R_e: ca.SX


def contact(p: Signals, n: ca.SX, s: ca.SX, *, height: ca.SX, v: ca.SX, omega: ca.SX) -> Contact:
    """The contact of a wheel with axle s whose centre is `height` above a road of normal n (all in K1).

    v, omega: velocity of the centre and angular velocity of the knuckle. With the camber component n.s = sin(gamma),
    |s x n| = |n - (n.s) s| = cos(gamma), so directions need one square root; it is kept from zero
    for a car on its side. In the air the contact is the lowest point of the tyre, without force.
    """
    tilt = ca.dot(n, s)
    inverse = 1 / ca.sqrt(ca.fmax(1 - tilt * tilt, 1e-4))
    x, y = ca.cross(s, n) * inverse, (s - tilt * n) * inverse
    r = ca.fmin(height * inverse, p["wheel.radius"])
    arm = (tilt * s - n) * (inverse * r)
    velocity = v + ca.cross(omega, arm)
    delta = p["wheel.radius"] - r
    squeeze = p["tyre.vertical_stiffness"] * delta - p["tyre.vertical_damping"] * ca.dot(velocity, n)
    F_z = ca.if_else(delta > 0, ca.fmax(squeeze, 0), 0)
    R_e = p["wheel.radius"] - delta / 3
    return Contact(x, y, arm, F_z, ca.dot(velocity, x), ca.dot(velocity, y), R_e)
