"""Spring, damper, anti-roll bar, stops and active force of the suspensions, and the stops of the steering."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals
from fmus.vehicle16dof.states import CORNERS


def spring_forces(p: Signals, q: ca.SX) -> list[ca.SX]:
    """Static force [N] of each corner, positive pushes body and wheel apart; q (4) travel in bump [m]."""
    forces = []
    for corner in CORNERS:
        key, travel = f"suspension.{corner.axle}", q[corner.index]
        spring = p[f"{key}.preload"] + p[f"{key}.stiffness"] * travel
        bar = p[f"{key}.anti_roll"] * (travel - q[corner.opposite])
        forces.append(spring + bar + stop(travel, p["suspension.travel"], p["suspension.stop_stiffness"]))
    return forces


def stored(p: Signals, q: ca.SX) -> list[ca.SX]:
    """Energy [J] behind `spring_forces` of each corner, which has half of its anti-roll bar's."""
    energies = []
    for corner in CORNERS:
        key, travel = f"suspension.{corner.axle}", q[corner.index]
        spring = p[f"{key}.preload"] * travel + 0.5 * p[f"{key}.stiffness"] * travel**2
        bar = 0.25 * p[f"{key}.anti_roll"] * (travel - q[corner.opposite]) ** 2
        energies.append(spring + bar + _pressed(travel, p["suspension.travel"], p["suspension.stop_stiffness"]))
    return energies


def corner_forces(p: Signals, u: Signals, q: ca.SX, rate: ca.SX) -> list[ca.SX]:
    """F_s = F_0 + k q + c q' + k_arb (q - q_opposite) + stops + f_act [N] of each corner."""
    return [
        spring + p[f"suspension.{corner.axle}.damping"] * rate[corner.index] + u[f"suspension_force.{corner.name}"]
        for corner, spring in zip(CORNERS, spring_forces(p, q), strict=True)
    ]


def steering_moment(p: Signals, torque: ca.SX, delta: ca.SX, rate: ca.SX) -> ca.SX:
    """Torque about a kingpin [N.m] from actuator, damper and stops."""
    return torque - p["steering.damping"] * rate - stop(delta, p["steering.limit"], p["steering.stop_stiffness"])


def stop(deflection: ca.SX, limit: ca.SX, stiffness: ca.SX) -> ca.SX:
    """Force of a pair of elastic stops at +-limit, zero in between."""
    return stiffness * (ca.fmax(deflection - limit, 0) - ca.fmax(-deflection - limit, 0))


def steering_stored(p: Signals, delta: ca.SX) -> ca.SX:
    """Energy [J] of the stops of all kingpins at the angles delta."""
    return ca.sum1(_pressed(delta, p["steering.limit"], p["steering.stop_stiffness"]))


def _pressed(deflection: ca.SX, limit: ca.SX, stiffness: ca.SX) -> ca.SX:
    """Energy [J] of `stop`."""
    return 0.5 * stiffness * ca.fmax(ca.fabs(deflection) - limit, 0) ** 2
