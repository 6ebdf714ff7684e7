"""From equations that take what they use to functions of all that their component has."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from inspect import signature
from typing import Any

import casadi as ca

from fmukit.interface import Interface
from fmukit.kernel.columns import Layout
from fmukit.kernel.functions import Expression, Shape, several, slots, symbols
from fmukit.kernel.kernel import Kernel

Equations = Callable[..., Any]
"""A function that takes, by name, those of the quantities of `fmukit.kernel` it uses."""


class Assembly:
    """The functions of one component.

    at_start  arguments of `initialise` and their shapes, by name
    now       arguments of every later function
    outputs   the layout of the outputs
    """

    def __init__(self, interface: Interface, states: Layout, derived: Layout) -> None:
        self._owner, self._states, self._derived = interface.name, states, derived
        p, u, self.outputs = (slots(interface, causality) for causality in ("parameter", "input", "output"))
        table = (len(interface.table.columns), interface.table.rows) if interface.table else 0
        self.at_start: dict[str, Shape] = {"p": p, "u": u, "w": interface.noise, "table": table, "rows": 1}
        self.now: dict[str, Shape] = {"p": p, "d": derived, "u": u, "x": states}

    def function(
        self,
        name: str,
        equations: Equations,
        arguments: Mapping[str, Shape],
        results: Mapping[str, Callable[[Any], Any]],
        *,
        symbol: Expression = ca.SX,
        cse: bool = False,
    ) -> ca.Function:
        """The function `name` of all `arguments`; each of `results` makes a column of what the equations give for it.

        With `cse` what they compute twice is computed once; CasADi then composes them anew, and last bits may change.
        ValueError for equations that take or give what is not there.
        """
        columns, seen = symbols(arguments, symbol)
        there = [key for key, column in columns.items() if column.numel()]
        taken = signature(equations).parameters
        if taken.keys() - set(there):
            lacking = sorted(taken.keys() - set(there))
            raise ValueError(f"{self._owner}: {name} takes {', '.join(lacking)}, but there is only {', '.join(there)}")
        found = several(equations(**{key: seen[key] for key in taken}))
        if len(found) != len(results):
            raise ValueError(f"{self._owner}: {name} gives {len(found)} results, not {len(results)}")
        try:
            made = [symbol(column(given)) for column, given in zip(results.values(), found, strict=True)]
        except ValueError as error:
            raise ValueError(f"{self._owner}: {name} gives {error}") from error
        return ca.Function(name, list(columns.values()), ca.cse(made) if cse else made, list(columns), list(results))

    def continuous(self, initialise: Equations, step: ca.Function, output: Equations, symbol: Expression) -> Kernel:
        """The kernel of a continuous component with this `step`; its first outputs are those of `output`."""
        begun = {"d": self._derived.begun, "x": self._states.begun}
        start = self.function("start", initialise, self.at_start, begun, symbol=symbol)
        tell = self.function("output", output, self.now, {"y": self.outputs.join}, cse=True)
        p, u, *rest = (symbol.sym(key, *start.size_in(key)) for key in self.at_start)
        d, x = start(p, u, *rest)
        names = list(self.at_start), ["d", "x", "y"]
        return Kernel(ca.Function("initialise", [p, u, *rest], [d, x, tell(p, d, u, x)], *names), step, tell)
