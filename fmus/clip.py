"""Values kept between limits."""

from __future__ import annotations

from typing import TypeVar

import casadi as ca

Symbol = TypeVar("Symbol", ca.SX, ca.MX)


def clip(value: Symbol, low: Symbol | ca.DM | float, high: Symbol | ca.DM | float) -> Symbol:
    """`value`, element by element, at least `low` and at most `high`."""
    return ca.fmin(ca.fmax(value, low), high)
