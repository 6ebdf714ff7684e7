"""A component that is a Python module, run from its source with the calls of a `Kernel`: see `fmukit.direct`."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module
from typing import Any

import casadi as ca
import numpy as np

from fmukit.build.compiler import host_platform
from fmukit.build.python_module import library
from fmukit.interface import Interface, Value, Variable
from fmukit.python_kernel import PythonKernel


class Played:
    """The functions of a `Kernel`; `overrides` gives the texts, for which a column of doubles has no place."""

    def __init__(self, kernel: PythonKernel, interface: Interface, overrides: Mapping[str, Value]) -> None:
        self._module = import_module(kernel.module)
        paths = {name: str(library(kernel, name, host_platform())) for name in kernel.libraries}
        self._tools = self._module.prepare(paths)
        self._parameters, self._inputs = interface.select("parameter"), interface.names("input")
        self._outputs, self._columns = interface.names("output"), len(interface.table.columns) if interface.table else 0
        self._overrides = overrides

    def initialise(self, *arguments: Any) -> tuple[ca.DM, ca.DM, ca.DM]:
        """(p, u, w, table, rows) -> (d, x, y), without noise."""
        p, u, _, table, rows = arguments
        cells = [table.full()[:, k].tolist() for k in range(int(rows))]
        d, x, y = self._module.initialise(self._tools, self._named(p), self._given(u), cells)
        return ca.DM(d), ca.DM(x), self._ordered(y)

    def step(self, *arguments: Any) -> tuple[ca.DM, ca.DM]:
        """(p, d, u, x, w, t) -> (x, y), without noise."""
        p, d, u, x, _, t = arguments
        x_next, y = self._module.sample(self._tools, self._named(p), d.tolist(), self._given(u), x.tolist(), t)
        return ca.DM(x_next), self._ordered(y)

    def _named(self, p: np.ndarray) -> dict[str, Value]:
        return {v.name: self._typed(v, float(value)) for v, value in zip(self._parameters, p, strict=True)}

    def _typed(self, variable: Variable, value: float) -> Value:
        if variable.type == "String":
            return str(self._overrides.get(variable.name, variable.start))
        if variable.type == "Real":
            return value
        return bool(value) if variable.type == "Boolean" else int(value)

    def _given(self, u: np.ndarray) -> dict[str, float]:
        return dict(zip(self._inputs, u.tolist(), strict=True))

    def _ordered(self, y: Mapping[str, float]) -> ca.DM:
        return ca.DM([float(y[name]) for name in self._outputs])
