"""Tyre forces from transient slip: combined slip, aligning moment, rolling resistance, relaxation, low speed.

Steady forces are Pacejka's Magic Formula (`magic`). kappa' and tan(alpha') lag the slip velocities by
relaxation lengths:
    sigma kappa'' = -V_sx - V kappa',   V = max(|V_x|, |V_sx|/limit)
At speed V = |V_x|, the usual relaxation, regular at V_x = 0; the second entry bounds the deflection of a sliding tyre.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from fmukit.kernel import Signals
from fmus.vehicle16dof import magic
from fmus.vehicle16dof.contact import Contact

FASTEST = 1000.0
"""Fastest decay [1/s] of a transient slip, for wheels spinning wildly; stable in steps of 1 ms (engineering choice)."""
CREEP = 0.05
"""Speed [m/s] up to which a contact patch turns as one at rest does (engineering choice)."""

Slips = tuple[ca.SX, ca.SX]
"""(kappa', tan(alpha'))."""


@dataclass(frozen=True, slots=True)
class TyreForce:
    """Forces [N] in the contact frame, aligning moment [N.m] about the upright, rolling moment [N.m] against spin."""

    F_x: ca.SX
    F_y: ca.SX
    M_z: ca.SX
    rolling: ca.SX


class TyreData(dict[str, ca.SX]):
    """The `tyre.*` parameters by name without the prefix, taken from the parameters on demand."""

    def __init__(self, p: Signals) -> None:
        super().__init__()
        self._p = p

    def __missing__(self, name: str) -> ca.SX:
        return self._p[f"tyre.{name}"]


def standstill(k: TyreData, V_x: ca.SX) -> ca.SX:
    """1 at rest, falling smoothly to 0 at tyre.low_speed.speed."""
    s = ca.fmin(ca.fabs(V_x) / k["low_speed.speed"], 1)
    return 1 - s * s * (3 - 2 * s)


def slip_rates(k: TyreData, c: Contact, spin: ca.SX, slips: Slips) -> Slips:
    """d/dt (kappa', tan(alpha')) [1/s] of the relaxing tyre."""
    kappa, tangent = slips
    V_sx = c.V_x - spin * c.R_e
    speed = ca.fabs(c.V_x)
    fast = ca.fmax(ca.fmin((speed / k["low_speed.speed"] - 1) / 3, 1), 0)
    limit = k["low_speed.slip"] + (k["slip_limit"] - k["low_speed.slip"]) * fast
    sigma_x, sigma_y = k["relaxation.longitudinal"], k["relaxation.lateral"]
    along = ca.fmin(ca.fmax(speed, ca.fabs(V_sx) / limit), FASTEST * sigma_x)
    across = ca.fmin(ca.fmax(speed, ca.fabs(c.V_y) / limit), FASTEST * sigma_y)
    return -(V_sx + along * kappa) / sigma_x, (c.V_y - across * tangent) / sigma_y


def force(k: TyreData, c: Contact, road: ca.SX, spin: ca.SX, slips: Slips) -> TyreForce:
    """All forces of one tyre turning at `spin` [rad/s] against a road of friction factor `road`, at transient slips."""
    kappa, tangent = _damped(k, c, spin, slips)
    F_x, F_y = combined(k, c.F_z, road, kappa, tangent)
    fade = ca.fmax(1 - ca.fabs(tangent) / k["trail_vanishing_slip"], 0)
    forward = ca.fmax(ca.fmin(c.V_x / 0.5, 1), -1)
    trail = k["trail"] * (c.F_z / k["nominal_load"]) * fade * forward
    speed2 = c.V_x * c.V_x
    f_r = k["rolling.constant"] + k["rolling.linear"] * ca.fabs(c.V_x) + k["rolling.quartic"] * speed2 * speed2
    return TyreForce(F_x, F_y, -trail * F_y, f_r * c.F_z * c.R_e * ca.tanh(spin / k["rolling.fade"]))


def combined(k: TyreData, F_z: ca.SX, road: ca.SX, kappa: ca.SX, tangent: ca.SX) -> tuple[ca.SX, ca.SX]:
    """(F_x, F_y) [N] of the Magic Formula with cosine weighting (Pacejka 2006, 4.E50, 4.E58).

    The load is taken no larger than four times nominal in the coefficients, where the fit ends.
    """
    largest = 4 * k["nominal_load"]
    fit_load, over = ca.fmin(F_z, largest), ca.fmax(F_z / largest, 1)
    F_x = magic.longitudinal(ca, k, fit_load, road, kappa) * over
    F_y = magic.lateral(ca, k, fit_load, road, tangent) * over
    B_x, B_y = (
        _weight_stiffness(k["combined.x_stiffness"], k["combined.x_falloff"] * kappa),
        _weight_stiffness(k["combined.y_stiffness"], k["combined.y_falloff"] * tangent),
    )
    return (
        F_x * ca.cos(k["combined.x_shape"] * ca.atan(B_x * tangent)),
        F_y * ca.cos(k["combined.y_shape"] * ca.atan(B_y * kappa)),
    )


def _weight_stiffness(r_1: ca.SX, x: ca.SX) -> ca.SX:
    """r_1 cos(atan(x)) without trigonometry."""
    return r_1 / ca.sqrt(1 + x * x)


def _damped(k: TyreData, c: Contact, spin: ca.SX, slips: Slips) -> Slips:
    """Slips with the low-speed damping k_V V_s / K added, K at nominal load."""
    kappa, tangent = slips
    k_V = k["low_speed.damping"] * standstill(k, c.V_x) / k["nominal_load"]
    K_x, K_y = k["longitudinal.stiffness"], 2 * k["lateral.stiffness"] / k["lateral.stiffness_load"]
    return kappa - k_V / K_x * (c.V_x - spin * c.R_e), tangent + k_V / K_y * c.V_y


def scrub_capacity(k: TyreData, c: Contact, road: ca.SX, turning: ca.SX) -> ca.SX:
    """Largest friction moment [N.m] of the contact patch against turning at this rate [rad/s].

    It fades out with speed: what a patch slides by turning is then little of what it rolls.
    """
    sliding = k["scrub_arm"] * ca.fabs(turning) + CREEP
    part = sliding / (sliding + ca.fabs(c.V_x)) * standstill(k, c.V_x)
    return k["scrub_arm"] * k["lateral.friction"] * road * c.F_z * part
