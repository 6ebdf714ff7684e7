"""A continuous component with a closed solution: mass on a spring, kicked by a force. For tests of fmukit only."""

from __future__ import annotations

from fmukit.component import Component
from fmukit.interface import continuous, input_, output, parameter
from fmukit.kernel import Kernel, Layout, Parts, Signals, continuous_kernel

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
    equations = {"initialise": initialise, "derivative": derivative, "output": output}
    return continuous_kernel(INTERFACE, states=states, derived=derived, **equations)


def initialise(p: Signals) -> tuple[Parts, Parts]:
    return {"omega2": p["spring.enabled"] * p["stiffness"] / p["mass"]}, {"q": p["initial.position"]}


def derivative(p: Signals, d: Parts, u: Signals, x: Parts) -> Parts:
    return {"q": x["v"], "v": (u["force"] + u["wind"]) / p["mass"] - d["omega2"] * x["q"]}


def output(p: Signals, d: Parts, x: Parts) -> Parts:
    energy = p["mass"] * (x["v"] ** 2 + d["omega2"] * x["q"] ** 2) / 2
    return {"position": x["q"], "speed": x["v"], "energy": energy}
