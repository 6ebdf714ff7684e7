"""One interval of the multiple shooting: Runge-Kutta over substeps with the input held."""

from __future__ import annotations

import casadi as ca


def interval(f: ca.Function, substeps: int) -> ca.Function:
    """(x, u, T) -> x after T seconds by the classical Runge-Kutta method.

    One substep is a function of its own, so that its derivatives are generated once, however many there are.
    """
    x, u, T = ca.MX.sym("x", f.size1_in(0)), ca.MX.sym("u", f.size1_in(1)), ca.MX.sym("T")
    step, state = _substep(f), x
    for _ in range(substeps):
        state = step(state, u, T / substeps)
    return ca.Function("interval", [x, u, T], [state], ["x", "u", "T"], ["end"])


def _substep(f: ca.Function) -> ca.Function:
    x, u, h = ca.SX.sym("x", f.size1_in(0)), ca.SX.sym("u", f.size1_in(1)), ca.SX.sym("h")
    k1 = f(x, u)
    k2 = f(x + h / 2 * k1, u)
    k3 = f(x + h / 2 * k2, u)
    k4 = f(x + h * k3, u)
    end = ca.cse(x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4))
    return ca.Function("substep", [x, u, h], [end], {"never_inline": True})
