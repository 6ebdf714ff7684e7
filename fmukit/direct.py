"""Run a component's kernel in this process, without an FMU: for tests, prototypes and the equality check of FMUs.

A component that is a Python module is run from its source, with its libraries compiled for this machine (see `played`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

import casadi as ca
import numpy as np

from fmukit.interface import Interface, Value
from fmukit.kernel import Component, Kernel
from fmukit.played import Played
from fmukit.python_kernel import PythonKernel

_MASK = 2**64 - 1


def normals(seed: int, index: int, count: int) -> list[float]:
    """`count` unit normals of sample `index` (0: initialisation, k + 1: sample k), as the FMU's C code draws them.

    SplitMix64 started at a hash of (seed, index), 53-bit uniforms, Box-Muller.
    """
    state = (_mix(seed & _MASK) ^ _mix((index + 0x9E3779B97F4A7C15) & _MASK)) & _MASK
    drawn: list[float] = []
    while len(drawn) < count:
        state, first = _next(state)
        state, second = _next(state)
        radius, angle = math.sqrt(-2.0 * math.log(first)), 2.0 * math.pi * second
        drawn += [radius * math.cos(angle), radius * math.sin(angle)]
    return drawn[:count]


def _mix(z: int) -> int:
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & _MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & _MASK
    return z ^ (z >> 31)


def _next(state: int) -> tuple[int, float]:
    state = (state + 0x9E3779B97F4A7C15) & _MASK
    return state, ((_mix(state) >> 11) + 0.5) * 2.0**-53


class Direct:
    """One instance of a component, its functions evaluated by casadi's own virtual machine.

    `parameters` and `inputs` are overrides by name of the start values; unknown names raise KeyError.
    """

    def __init__(
        self,
        component: Component,
        parameters: Mapping[str, Value] | None = None,
        inputs: Mapping[str, float] | None = None,
        table: np.ndarray | None = None,
        kernel: Kernel | PythonKernel | None = None,
    ) -> None:
        self.interface = component.interface
        made = kernel or component.kernel()
        self.kernel = Played(made, self.interface, parameters or {}) if isinstance(made, PythonKernel) else made
        self.p = _start(self.interface, "parameter", parameters or {})
        self.u = _start(self.interface, "input", inputs or {})
        self.samples = 0
        names = self.interface.names("parameter")
        self._seed = int(self.p[names.index("seed")]) if "seed" in names else 0
        self._inputs = {name: i for i, name in enumerate(self.interface.names("input"))}
        self._outputs = {name: i for i, name in enumerate(self.interface.names("output"))}
        padded, rows = self._padded(table)
        results = self.kernel.initialise(self.p, self.u, self._normals(0), padded, rows)
        self.d, self.x, self.y = map(_flat, results)

    def set(self, values: Mapping[str, float]) -> None:
        """Set inputs by name; unknown names raise KeyError."""
        for name, value in values.items():
            self.u[self._inputs[name]] = value

    def __getitem__(self, name: str) -> float:
        return float(self.y[self._outputs[name]])

    def outputs(self) -> dict[str, float]:
        """The outputs by name, without `fault`."""
        return {name: float(self.y[i]) for name, i in self._outputs.items()}

    def sample(self, period: float | None = None) -> None:
        """One sample of a sampled component, at its own period unless told."""
        t = self.samples * (period or self.interface.step)
        self.samples += 1
        x, y = self.kernel.step(self.p, self.d, self.u, self.x, self._normals(self.samples), t)
        self.x, self.y = _flat(x), _flat(y)

    def advance(self, duration: float) -> None:
        """Integrate a continuous component over `duration` [s] with inputs held."""
        assert isinstance(self.kernel, Kernel)
        assert self.kernel.output is not None
        count = substeps(duration, self.interface.max_substep)
        for _ in range(count):
            self.x = self.kernel.step(self.p, self.d, self.u, self.x, duration / count).full().ravel()
        self.y = self.kernel.output(self.p, self.d, self.u, self.x).full().ravel()

    def _normals(self, index: int) -> ca.DM:
        return ca.DM(normals(self._seed, index, self.interface.noise)) if self.interface.noise else ca.DM.zeros(0, 1)

    def _padded(self, table: np.ndarray | None) -> tuple[ca.DM, int]:
        spec = self.interface.table
        if spec is None:
            return ca.DM.zeros(0, 1), 0
        full = np.zeros((spec.rows, len(spec.columns)))
        rows = 0 if table is None else len(table)
        if table is not None:
            full[:rows], full[rows:] = table, table[-1]
        return ca.DM(full.T), rows


def substeps(duration: float, longest: float) -> int:
    """How many equal substeps no longer than `longest` make up `duration`; rounding noise adds none."""
    return max(1, math.ceil(duration / longest * (1.0 - 1e-9)))


def _flat(result: ca.DM | np.ndarray) -> np.ndarray:
    return result if isinstance(result, np.ndarray) else np.asarray(result.full()).ravel()


def _start(interface: Interface, causality: str, overrides: Mapping[str, Value]) -> np.ndarray:
    variables = interface.select(causality)  # type: ignore[arg-type]
    unknown = overrides.keys() - {variable.name for variable in variables}
    if unknown:
        raise KeyError(f"{interface.name} has no {causality} {', '.join(sorted(unknown))}")
    return np.array(list(_slots(variables, overrides)))


def _slots(variables, overrides: Mapping[str, Value]) -> Iterator[float]:  # type: ignore[no-untyped-def]
    for variable in variables:
        value = overrides.get(variable.name, variable.start)
        yield 0.0 if isinstance(value, str) else float(value)
