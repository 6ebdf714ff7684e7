"""A continuous component with a closed solution: mass on a spring, kicked by a force. For tests of fmukit only."""

from __future__ import annotations

import casadi as ca

from fmukit.component import Component
from fmukit.interface import continuous, input_, output, parameter
from fmukit.kernel import Kernel, Layout, continuous_kernel, stack, symbols

INTERFACE = continuous(
    "DemoSpring",
    "Mass on a spring with a force acting on it",
    step=1e-3,
    max_substep=1e-3,
    variables=[
        parameter("mass", "kg", "mass", 2.0, minimum=0.1, maximum=1e3),
        parameter("stiffness", "N/m", "stiffness of the spring", 50.0, minimum=0.0),
        parameter("initial.position", "m", "position at the start", 0.25, minimum=-1.0, maximum=1.0),
        parameter("spring.enabled", "1", "whether the spring is attached", True),
        input_("force", "N", "force on the mass", minimum=-1e4, maximum=1e4),
        input_("wind", "N", "another force", minimum=-1e4, maximum=1e4),
        output("position", "m", "position of the mass"),
        output("speed", "m/s", "speed of the mass"),
        output("energy", "J", "kinetic and spring energy"),
    ],
)
COMPONENT = Component(INTERFACE, "demo_spring")


def kernel() -> Kernel:
    states, derived = Layout(q=1, v=1), Layout(omega2=1)
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    x, d, h = states.symbol(), derived.symbol("d"), ca.SX.sym("h")
    none = ca.SX.sym("none", 0)

    omega2 = p["spring.enabled"] * p["stiffness"] / p["mass"]
    x0 = ca.vertcat(p["initial.position"], 0.0)

    def rate(x: ca.SX) -> ca.SX:
        return ca.vertcat(x[1], (u["force"] + u["wind"]) / p["mass"] - d * x[0])

    k1 = rate(x)
    k2 = rate(x + h / 2 * k1)
    k3 = rate(x + h / 2 * k2)
    k4 = rate(x + h * k3)

    def y(x: ca.SX, omega2: ca.SX) -> ca.SX:
        energy = p["mass"] * (x[1] ** 2 + omega2 * x[0] ** 2) / 2
        return stack(INTERFACE.names("output"), {"position": x[0], "speed": x[1], "energy": energy})

    return continuous_kernel(
        INTERFACE,
        states=states,
        derived=derived,
        initialise=ca.Function(
            "initialise", [p.column, u.column, none, none, ca.SX.sym("rows")], [omega2, x0, y(x0, omega2)]
        ),
        step=ca.Function("step", [p.column, d, u.column, x, h], [x + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)]),
        output=ca.Function("output", [p.column, d, u.column, x], [y(x, d)]),
    )
