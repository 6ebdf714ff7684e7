"""Vehicle16Dof under LowLevelPid with true states, both compiled, in one loop of 1 ms: for tests of the driven car."""

from __future__ import annotations

import functools
import os
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Mapping
from typing import Any

import casadi as ca
import numpy as np

from fmukit.direct import Direct
from fmukit.kernel import Component, Kernel
from fmus import vehicle16dof
from fmus.controllers import low_level_pid

H, PERIODS = 1e-3, 10
"""Step of both [s], and how many of them the inputs are held."""
_TRUE = {
    "estimate.velocity.x": "velocity.x",
    "estimate.velocity.y": "velocity.y",
    "estimate.yaw_rate": "angular_rate.z",
    "estimate.roll": "roll",
    "estimate.pitch": "pitch",
    "estimate.roll_rate": "angular_rate.x",
    "estimate.pitch_rate": "angular_rate.y",
}
Script = Callable[[float, "Drive"], Mapping[str, float]]
CAR, LOW_LEVEL = vehicle16dof.COMPONENT, low_level_pid.COMPONENT


@functools.cache
def kernel(component: Component) -> Kernel:
    """Of a component, in machine code if there is a compiler."""
    plain, compiler = component.kernel(), os.environ.get("CC") or shutil.which("cc")
    if not compiler:
        return plain
    folder, name = tempfile.mkdtemp(), component.interface.name
    generator = ca.CodeGenerator(f"{name}.c")
    functions = [f for f in (plain.initialise, plain.step, plain.output) if f is not None]
    for function in functions:
        generator.add(function)
    generator.generate(f"{folder}/")
    library = f"{folder}/{name}.so"
    subprocess.run(
        [*compiler.split(), "-O1", "-shared", "-fPIC", f"{folder}/{name}.c", "-o", library, "-lm"], check=True
    )
    return Kernel(*(ca.external(f.name(), library) for f in functions))


@functools.cache
def loop() -> ca.Function:
    """(x, x_llc, y) -> the same after PERIODS samples, under held (p, d, u) of car and controller."""
    car, llc = kernel(CAR), kernel(LOW_LEVEL)
    assert car.output is not None
    names = ("p", "d", "u", "x")
    p, d, u, x = (ca.MX.sym(name, car.step.size1_in(i)) for i, name in enumerate(names))
    p_l, d_l, u_l, x_l = (ca.MX.sym(f"{name}_l", llc.step.size1_in(i)) for i, name in enumerate(names))
    y, y_l = ca.MX.sym("y", car.output.size1_out(0)), ca.MX.sym("y_l", llc.step.size1_out(1))
    seen = _fed(u_l, y, LOW_LEVEL, CAR)
    x_l_next, told = llc.step(p_l, d_l, seen, x_l, ca.DM.zeros(0, 1), 0)
    given = _fed(u, told, CAR, LOW_LEVEL)
    x_next = car.step(p, d, given, x, H)
    y_next = car.output(p, d, given, x_next)
    before, held = [x, x_l, y, y_l], [p, d, u, p_l, d_l, u_l]
    state = ca.vertcat(*before)
    once = ca.Function("once", [state, *held], [ca.vertcat(x_next, x_l_next, y_next, told)])
    after: Any = state
    for _ in range(PERIODS):
        after = once(after, *held)
    ends = np.cumsum([0, *(part.size1() for part in before)]).tolist()
    return ca.Function("loop", [*before, *held], ca.vertsplit(after, ends))


def _fed(inputs: ca.MX, outputs: ca.MX, listener: Component, source: Component) -> ca.MX:
    """The inputs of the listener, those that the source knows replaced by its outputs."""
    there = source.interface.names("output")
    names = [_TRUE.get(name, name) for name in listener.interface.names("input")]
    return ca.vertcat(*(outputs[there.index(n)] if n in there else inputs[i] for i, n in enumerate(names)))


class Drive:
    """One car and its low-level controller."""

    def __init__(self, plant: Mapping[str, float] | None = None, controller: Mapping[str, float] | None = None) -> None:
        self.car = Direct(CAR, plant, kernel=kernel(CAR))
        self.llc = Direct(LOW_LEVEL, controller, kernel=kernel(LOW_LEVEL))
        assert self.car.kernel.output is not None
        self.car.y = self.car.kernel.output(self.car.p, self.car.d, self.car.u, self.car.x).full().ravel()
        self.time = 0.0

    def run(
        self, duration: float, script: Script, until: Callable[[Drive], bool] = lambda _: False
    ) -> dict[str, np.ndarray]:
        """Drive on for a time [s], or until something is true; `script(t, drive)` sets inputs of either.

        Returns the outputs of the car and, as llc.*, of the controller, every PERIODS samples.
        """
        rows, car, llc = [], self.car, self.llc
        for _ in range(round(duration / H / PERIODS)):
            for name, value in script(self.time, self).items():
                (car if name.startswith(("road_", "body_")) else llc).set({name: value})
            found = loop()(car.x, llc.x, car.y, llc.y, car.p, car.d, car.u, llc.p, llc.d, llc.u)
            car.x, llc.x, car.y, llc.y = (part.full().ravel() for part in found)
            self.time += H * PERIODS
            rows.append(np.concatenate([[self.time], car.y, llc.y]))
            if until(self):
                break
        names = ["time", *car.interface.names("output"), *(f"llc.{n}" for n in llc.interface.names("output"))]
        return dict(zip(names, np.array(rows).T, strict=True))
