"""Pure Magic Formula of the tyre (Pacejka 2006, ch. 4.3.2, ISO signs, no camber, all shifts zero).

`m` is the module of elementary functions, `math` or `casadi`, so that design data and plant share one formula.
`k` maps the `tyre.*` parameter names without prefix to numbers or symbols.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def load_change(k: Mapping[str, Any], F_z: Any) -> Any:
    """df = (F_z - F_z0)/F_z0 [1] (4.E2a)."""
    return F_z / k["nominal_load"] - 1.0


def formula(m: Any, B: Any, C: Any, E: Any, s: Any) -> Any:
    """sin(C atan(B s - E (B s - atan(B s)))) [1] (4.6): the force over its peak D at slip s."""
    Bs = B * s
    return m.sin(C * m.atan(Bs - E * (Bs - m.atan(Bs))))


def longitudinal(m: Any, k: Mapping[str, Any], F_z: Any, road: Any, kappa: Any) -> Any:
    """F_x0 [N] at slip ratio kappa (4.E9): B = K/(C D) with K_x ~ F_z and D ~ F_z, so no division by the load."""
    C, df = k["longitudinal.shape"], load_change(k, F_z)
    mu = (k["longitudinal.friction"] + k["longitudinal.friction_load"] * df) * road
    E = k["longitudinal.curvature"] + (k["longitudinal.curvature_load"] + k["longitudinal.curvature_load2"] * df) * df
    return mu * F_z * formula(m, longitudinal_stiffness(m, k, df) / (C * mu), C, E, kappa)


def longitudinal_stiffness(m: Any, k: Mapping[str, Any], df: Any) -> Any:
    """K_x / F_z [1] (4.E15)."""
    return (k["longitudinal.stiffness"] + k["longitudinal.stiffness_load"] * df) * m.exp(
        k["longitudinal.stiffness_exponent"] * df
    )


def lateral(m: Any, k: Mapping[str, Any], F_z: Any, road: Any, tan_alpha: Any) -> Any:
    """F_y0 [N] at slip tan(alpha) (4.E19); negative for positive slip."""
    C, df = k["lateral.shape"], load_change(k, F_z)
    mu = (k["lateral.friction"] + k["lateral.friction_load"] * df) * road
    E = k["lateral.curvature"] + k["lateral.curvature_load"] * df
    return -mu * F_z * formula(m, lateral_stiffness(k, F_z) / (C * mu), C, E, tan_alpha)


def lateral_stiffness(k: Mapping[str, Any], F_z: Any) -> Any:
    """K_y / F_z [1] (4.E25): sin(2 atan x) = 2 x/(1 + x^2), hence finite without load."""
    x = F_z / (k["lateral.stiffness_load"] * k["nominal_load"])
    return 2.0 * k["lateral.stiffness"] / k["lateral.stiffness_load"] / (1.0 + x * x)
