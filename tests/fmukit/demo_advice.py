"""A sampled component that advises against a low threshold. For tests of fmukit only."""

from __future__ import annotations

import casadi as ca

from fmukit.component import Component
from fmukit.interface import Advice, input_, output, parameter, sampled
from fmukit.kernel import Kernel, Parts, Signals, sampled_kernel

INTERFACE = sampled(
    "DemoAdvice",
    "Says when its threshold is low",
    step=1e-2,
    variables=[
        parameter("threshold", "m", "threshold", 2.0, minimum=0.0),
        parameter("limit.low", "m", "what is low", 1.5),
        input_("bar", "m", "what makes it low as well"),
        output("low", "1", "1 while the threshold is low, else 0"),
    ],
    advice=[Advice("low", "threshold = {threshold} is 100 % below {limit.low}; raise it")],
)
COMPONENT = Component(INTERFACE, "demo_advice")


def kernel() -> Kernel:
    return sampled_kernel(INTERFACE, initialise=lambda p, u: ({}, {}, low(p, u)), sample=lambda p, u: ({}, low(p, u)))


def low(p: Signals, u: Signals) -> Parts:
    return {"low": p["threshold"] < ca.fmax(p["limit.low"], u["bar"])}
