"""Selectable error differential equations: the acceleration that gives an error n equal poles at -lambda."""

from __future__ import annotations

import casadi as ca


def double_pole(pole: ca.SX, error: ca.SX, integral: ca.SX) -> ca.SX:
    """e' + 2 lambda e + lambda^2 int(e) = 0, for a plant of relative degree one."""
    return 2 * pole * error + pole**2 * integral


def triple_pole(pole: ca.SX, rate: ca.SX, error: ca.SX, integral: ca.SX) -> ca.SX:
    """e'' + 3 lambda e' + 3 lambda^2 e + lambda^3 int(e) = 0, for a plant of relative degree two."""
    return 3 * pole * rate + 3 * pole**2 * error + pole**3 * integral
