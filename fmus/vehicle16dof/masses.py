"""The mass distribution of the car: everything that depends on its parameters only."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Parts, Signals, block, slots
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import CORNERS, symmetric, unsprung_mass, wheel_place


@block(p=slots(INTERFACE, "parameter"))
def masses(p: Signals) -> Parts:
    """The derived values, see `states.DERIVED`.

    A shift of the total centre of gravity moves the sprung body by m/m_1 of it; the payload is a point mass.
    """
    m_1, m_u = p["body.mass"], unsprung_mass(p)
    c = p.vector("body.cog", "xyz") + p.vector("cog_offset", "xyz") * (m_1 + 4.0 * m_u) / m_1
    place, load = p.vector("payload", "xyz"), p["payload.mass"]
    I_x, I_y, I_z = ca.vertsplit(p.vector("body.inertia", "xyz"))
    J = symmetric(ca.vertcat(I_x, I_y, I_z, 0, p["body.inertia.xz"], 0)) + _steiner(m_1, c) + _steiner(load, place)
    mass = m_1 + load
    centres = [wheel_place(p, corner) for corner in CORNERS]
    return {
        "mass": mass,
        "mass_moment": m_1 * c + load * place,
        "inertia": ca.vertcat(J[0, 0], J[1, 1], J[2, 2], J[0, 1], J[0, 2], J[1, 2]),
        "inverse_mass": ca.vertcat(1.0 / mass, 1.0 / (mass + 4.0 * m_u)),
        "unsprung_moment": m_u * ca.vertcat(sum(x for x, _, _ in centres), sum(y for _, y, _ in centres)),
        "unsprung_inertia": m_u * sum(x * x + y * y for x, y, _ in centres),
    }


def _steiner(m: ca.SX, c: ca.SX) -> ca.SX:
    """-m [c]x^2: inertia [kg m2] of the mass m [kg] at c [m] about the origin."""
    return m * (ca.dot(c, c) * ca.SX.eye(3) - c @ c.T)
