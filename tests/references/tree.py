"""The kinematic tree of Vehicle16Dof in modified Denavit-Hartenberg parameters (Khalil and Kleinfinger).

iTj = Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d) Rot(z, theta) Trans(z, r), i the antecedent of j.
A revolute joint (sigma = 0) moves theta = q + theta_0, a prismatic one (sigma = 1) r = q + r_0. Body 0 is the
moving base B1; the joints keep the order of the bodies B2 ... B11 of the README's table.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from fmukit.kernel import Parts, Signals
from fmus.cars.rotation import rotation_x, rotation_z
from fmus.vehicle16dof.states import CORNERS, Corner, symmetric, wheel_place


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


def bodies(p: Signals, d: Parts) -> tuple[Body, ...]:
    """The eleven bodies: chassis, then per corner carrier (massless), knuckle, wheel; rear carrier = knuckle."""
    zero = ca.SX.zeros(3)
    knuckle = Body(p["knuckle.mass"], zero, ca.diag(p.vector("knuckle.inertia", "xyz")))
    across, spin = p["wheel.inertia.diametral"], p["wheel.inertia.spin"]
    wheel = Body(p["wheel.mass"], zero, ca.diag(ca.vertcat(across, across, spin)))
    chain: list[Body] = [Body(d["mass"], d["mass_moment"], symmetric(d["inertia"]))]
    for corner in CORNERS:
        chain += [Body(0.0, zero, ca.SX(3, 3)), knuckle, wheel] if corner.steered else [knuckle, wheel]
    return tuple(chain)
