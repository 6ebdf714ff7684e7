"""A component that is a Python module, run from its source with the calls of a `Kernel`: see `fmukit.direct`."""

from __future__ import annotations

from array import array
from collections.abc import Mapping
from importlib import import_module
from typing import Any

import numpy as np

from fmukit.compiling.compiler import host_platform
from fmukit.compiling.functions import library
from fmukit.interface import Interface, Value, Variable
from fmukit.python_kernel import PythonKernel


class Played:
    """The functions of a `Kernel`; `overrides` gives the texts, for which a column of doubles has no place."""

    def __init__(self, kernel: PythonKernel, interface: Interface, overrides: Mapping[str, Value]) -> None:
        self._module = import_module(kernel.module)
        paths = {name: str(library(functions, name, host_platform())) for name, functions in kernel.libraries.items()}
        self._tools = self._module.prepare(paths)
        self._parameters, self._inputs = interface.select("parameter"), interface.names("input")
        self._outputs, self._columns = interface.names("output"), len(interface.table.columns) if interface.table else 0
        self._overrides = overrides

    def initialise(self, *arguments: Any) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(p, u, w, table, rows) -> (d, x, y), without noise."""
        p, u, _, table, rows = arguments
        cells = table.full()[:, : int(rows)].T.tolist()
        d, x, y = self._module.initialise(self._tools, self._named(p), self._given(u), cells)
        return np.array(d, dtype=float), np.array(x, dtype=float), self._ordered(y)

    def step(self, *arguments: Any) -> tuple[np.ndarray, np.ndarray]:
        """(p, d, u, x, w, t) -> (x, y), without noise."""
        p, d, u, x, _, t = arguments
        given = array("d", d.tobytes()), self._given(u), array("d", x.tobytes())
        x_next, y = self._module.sample(self._tools, self._named(p), *given, t)
        return np.array(x_next, dtype=float), self._ordered(y)

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

    def _ordered(self, y: Mapping[str, float]) -> np.ndarray:
        return np.array([y[name] for name in self._outputs], dtype=float)
