"""One Runge-Kutta step of order four."""

from __future__ import annotations

import casadi as ca

from fmus.vehicle16dof.states import STATES


def rk4(derivative: ca.Function, p: ca.MX, d: ca.MX, u: ca.MX) -> ca.Function:
    """(p, d, u, x, h) -> x after h [s]; `derivative` (p, d, u, x) -> x' stays a call, so the C code holds it once."""
    x, h = ca.MX.sym("x", STATES.size), ca.MX.sym("h")
    k_1 = derivative(p, d, u, x)
    k_2 = derivative(p, d, u, x + h / 2 * k_1)
    k_3 = derivative(p, d, u, x + h / 2 * k_2)
    k_4 = derivative(p, d, u, x + h * k_3)
    after = x + h / 6 * (k_1 + 2 * (k_2 + k_3) + k_4)
    return ca.Function("step", [p, d, u, x, h], [normalised()(after)], ["p", "d", "u", "x", "h"], ["x_next"])


def normalised() -> ca.Function:
    """x with its quaternion of unit length."""
    x = STATES.symbol()
    parts = STATES.split(x)
    q = parts["attitude"]
    parts["attitude"] = q / ca.sqrt(ca.sumsqr(q))
    return ca.Function("normalised", [x], [STATES.join(parts)])
