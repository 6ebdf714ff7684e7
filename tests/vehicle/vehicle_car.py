"""A car for tests: named states, sampled runs, and its kernel compiled."""

from __future__ import annotations

import subprocess
from collections.abc import Callable, Mapping
from pathlib import Path

import casadi as ca
import numpy as np

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.vehicle16dof.states import STATES

Control = Callable[[float, "Car"], Mapping[str, float]]


def _slices() -> dict[str, slice]:
    ends = np.cumsum(list(STATES.sizes.values()))
    return {
        name: slice(int(end) - size, int(end)) for (name, size), end in zip(STATES.sizes.items(), ends, strict=True)
    }


SLICES = _slices()


class Car(Direct):
    """A car with named states, and runs that sample the outputs."""

    def state(self, name: str) -> np.ndarray:
        return self.x[SLICES[name]]

    def run(
        self,
        duration: float,
        control: Control | None = None,
        *,
        h: float = 1e-3,
        every: float = 0.01,
    ) -> dict[str, np.ndarray]:
        """Integrate with steps `h`, calling `control(t, car)` for new inputs and sampling outputs `every` seconds."""
        period, rows = round(every / h), []
        many = self.kernel.step.mapaccum("many", period, ["x"], ["x_next"])
        for k in range(round(duration / every)):
            if control is not None:
                self.set(control(k * every, self))
            self.x = many(self.p, self.d, self.u, self.x, h)[:, -1].full().ravel()
            self.y = self.kernel.output(self.p, self.d, self.u, self.x).full().ravel()
            rows.append(self.y)
        return dict(zip(self.outputs(), np.array(rows).T, strict=True))


def compiled(plain: Kernel, compiler: str, folder: Path) -> Kernel:
    generator = ca.CodeGenerator("plant.c")
    for function in (plain.initialise, plain.step, plain.output):
        generator.add(function)
    generator.generate(f"{folder}/")
    library = folder / "plant.so"
    source = folder / "plant.c"
    subprocess.run([*compiler.split(), "-O1", "-shared", "-fPIC", str(source), "-o", str(library), "-lm"], check=True)
    return Kernel(*(ca.external(name, str(library)) for name in ("initialise", "step", "output")))
