"""A sampled component that advises against a low threshold. For tests of fmukit only."""

from __future__ import annotations

import casadi as ca

from fmukit.component import Component
from fmukit.interface import Advice, output, parameter, sampled
from fmukit.kernel import Kernel, Layout, sampled_kernel, symbols

INTERFACE = sampled(
    "DemoAdvice",
    "Says when its threshold is low",
    step=1e-2,
    variables=[
        parameter("threshold", "m", "threshold", 2.0, minimum=0.0),
        parameter("limit.low", "m", "what is low", 1.5),
        output("low", "1", "1 while the threshold is low, else 0"),
    ],
    advice=[Advice("low", "threshold = {threshold} is 100 % below {limit.low}; raise it")],
)
COMPONENT = Component(INTERFACE, "demo_advice")


def kernel() -> Kernel:
    p = symbols(INTERFACE, "parameter")
    none = [ca.SX.sym(name, 0) for name in ("u", "w", "table", "x", "d")]
    u, w, table, x, d = none
    y = p["threshold"] < p["limit.low"]
    return sampled_kernel(
        INTERFACE,
        states=Layout(),
        derived=Layout(),
        initialise=ca.Function("initialise", [p.column, u, w, table, ca.SX.sym("rows")], [d, x, y]),
        step=ca.Function("step", [p.column, d, u, x, w, ca.SX.sym("t")], [x, y]),
    )
