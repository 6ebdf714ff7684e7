"""The kinematic tree of the car in modified Denavit-Hartenberg parameters (Khalil and Kleinfinger).

iTj = Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r), i the antecedent of j.
A revolute joint (sigma = 0) moves theta = q + theta_0, a prismatic one (sigma = 1) r = q + r_0. Body 0 is the
moving base B1; the joints keep the order of the bodies B2 ... B11 of the README's table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from fmukit.kernel import Signals
from fmus.cars.rotation import rotation_x, rotation_z
from fmus.vehicle16dof.states import CORNERS, Corner, symmetric, unsprung_mass, wheel_place


@dataclass(frozen=True, slots=True)
class Joint:
    """One row of the table: antecedent body, sigma, and the constants of the transform [rad, m]."""

    name: str
    antecedent: int
    prismatic: bool
    gamma: Any = 0.0
    b: Any = 0.0
    alpha: Any = 0.0
    d: Any = 0.0
    theta: Any = 0.0
    r: Any = 0.0

    def transform(self, q: Any) -> tuple[ca.SX, ca.SX]:
        """(iRj, iPj): rotation from K_j to K_i and origin of K_j in K_i at joint coordinate q."""
        theta = self.theta if self.prismatic else self.theta + q
        r = self.r + q if self.prismatic else self.r
        fixed = rotation_z(self.gamma) @ rotation_x(self.alpha)
        rotation = fixed @ rotation_z(theta)
        place = rotation_z(self.gamma) @ ca.vertcat(self.d, 0, self.b) + fixed @ ca.vertcat(0, 0, r)
        return rotation, place


@dataclass(frozen=True, slots=True)
class Body:
    """Mass [kg], mass moment m rho [kg m] and inertia about the frame origin [kg m2], in the body frame."""

    mass: Any
    mass_moment: Any
    inertia: Any


def joints(p: Signals) -> tuple[Joint, ...]:
    """The ten joints of the car from its parameters: per corner suspension, (front) steering, wheel."""
    rows: list[Joint] = []
    for corner in CORNERS:
        rows.append(_suspension(p, corner))
        if corner.steered:
            rows.append(Joint(f"steer.{corner.name}", len(rows), False))
        rows.append(Joint(f"wheel.{corner.name}", len(rows), False, alpha=-ca.pi / 2))
    return tuple(rows)


def _suspension(p: Signals, corner: Corner) -> Joint:
    x, y, z = wheel_place(p, corner)
    gamma = ca.atan2(y, x)
    return Joint(f"travel.{corner.name}", 0, True, gamma=gamma, d=ca.sqrt(x * x + y * y), theta=-gamma, r=z)


def bodies(p: Signals, d: dict[str, ca.SX]) -> tuple[Body, ...]:
    """The eleven bodies: chassis, then per corner carrier (massless), knuckle, wheel; rear carrier = knuckle."""
    zero = ca.SX.zeros(3)
    knuckle = Body(p["knuckle.mass"], zero, ca.diag(p.vector("knuckle.inertia", "xyz")))
    across, spin = p["wheel.inertia.diametral"], p["wheel.inertia.spin"]
    wheel = Body(p["wheel.mass"], zero, ca.diag(ca.vertcat(across, across, spin)))
    chain: list[Body] = [Body(d["mass"], d["mass_moment"], symmetric(d["inertia"]))]
    for corner in CORNERS:
        chain += [Body(0.0, zero, ca.SX(3, 3)), knuckle, wheel] if corner.steered else [knuckle, wheel]
    return tuple(chain)


def derived(p: Signals) -> dict[str, ca.SX]:
    """Everything of the mass distribution that depends on the parameters only; see `states.DERIVED`.

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
