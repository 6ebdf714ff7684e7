"""The car at rest under any load: heave, roll, pitch and four travels by Newton's method.

Residual: vertical force, roll and pitch moment about O1, and the four suspension joints, with level axles and no slip.
Only normal forces act, so the other three base equations hold by themselves.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals, block, slots
from fmus.vehicle16dof import suspension
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import CORNERS, DERIVED, over_wheels, unsprung_mass, wheel_place

ITERATIONS = 15
"""Newton steps; the problem is nearly linear, so 4 suffice unless wheels lift or stops engage (engineering choice)."""


def found(p: Signals, d: Parts, u: Signals) -> ca.MX:
    """s (7) = (height of O1, roll, pitch, travel (4)); wheels may be in the air, not all of them."""
    s = guess(p, u)
    for _ in range(ITERATIONS):
        s = newton_step(s, p, d, u)
    return s


@block(s=7, p=slots(INTERFACE, "parameter"), d=DERIVED, u=slots(INTERFACE, "input"))
def newton_step(s: ca.SX, p: Signals, d: Parts, u: Signals) -> ca.SX:
    """s - (dr/ds)^-1 r(s)."""
    r = residual(p, d, u, s)
    return ca.cse(s - ca.solve(ca.jacobian(r, s), r))


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"))
def guess(p: Signals, u: Signals) -> ca.SX:
    """The chassis level with the road as far as four heights allow, all tyres sunk by about two centimetres."""
    l_F, l_R = p["geometry.front_axle"], p["geometry.rear_axle"]
    fl, fr, rl, rr = (u[f"road_height.{c.name}"] - wheel_place(p, c)[2] + p["wheel.radius"] - 0.02 for c in CORNERS)
    front, rear = 0.5 * (fl + fr), 0.5 * (rl + rr)
    roll = 0.5 * ((fl - fr) / p["geometry.track_front"] + (rl - rr) / p["geometry.track_rear"])
    height = (l_R * front + l_F * rear) / (l_F + l_R)
    twist = 0.25 * ((fl - fr) - (rl - rr))
    return ca.vertcat(height, roll, (rear - front) / (l_F + l_R), twist, -twist, -twist, twist)


def residual(p: Signals, d: Parts, u: Signals, s: ca.SX) -> ca.SX:
    z, roll, pitch, q = s[0], s[1], s[2], s[3:]
    n = ca.vertcat(-ca.sin(pitch), ca.cos(pitch) * ca.sin(roll), ca.cos(pitch) * ca.cos(roll))
    g, m_u = p["gravity"], unsprung_mass(p)
    springs = suspension.corner_forces(p, u, q, ca.SX.zeros(4))
    forces, moments, legs = [], [], []
    for corner in CORNERS:
        place = ca.vertcat(*wheel_place(p, corner)) + ca.vertcat(0, 0, q[corner.index])
        F, arm = _normal_force(p, n, z + ca.dot(n, place) - u[f"road_height.{corner.name}"])
        forces.append(F - m_u * g)
        moments.append(ca.cross(F * (place + arm) - m_u * g * place, n))
        legs.append((F - m_u * g) * n[2] - springs[corner.index])
    force = over_wheels(forces) - d["mass"] * g
    moment = over_wheels(moments) - g * ca.cross(d["mass_moment"], n)
    return ca.vertcat(force, moment[:2], *legs)


def _normal_force(p: Signals, n: ca.SX, height: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(F_z, arm from wheel centre to contact) of an unsteered wheel with its centre `height` above the road."""
    s = ca.vertcat(0, 1, 0)
    cosine = ca.sqrt(1 - n[1] * n[1])
    r = height / cosine
    return p["tyre.vertical_stiffness"] * ca.fmax(p["wheel.radius"] - r, 0) / cosine, r / cosine * (n[1] * s - n)
