"""A `Kernel` from the equations of a component."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, replace
from inspect import signature
from typing import TYPE_CHECKING, Any

import casadi as ca

from fmukit.integration import stages
from fmukit.interface import Interface
from fmukit.kernel.columns import Layout, Parts
from fmukit.kernel.functions import Expression, Shape, several, slots, symbols
from fmukit.kernel.kernel import Kernel

if TYPE_CHECKING:
    from fmukit.qp.solver import QpSolver

Equations = Callable[..., Any]
"""A function that takes those of p, u, d, x, w, t, h, table and rows it uses, by name."""
_NONE = Layout()


def sampled_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    sample: Equations,
    states: Layout = _NONE,
    derived: Layout = _NONE,
    symbol: Expression = ca.SX,
    solvers: Iterable[QpSolver] = (),
) -> Kernel:
    """The kernel of a component that computes on its own grid.

    initialise  of p, u, w, table, rows -> derived values, states, outputs by name; what is left out is zero
    sample      of p, u, d, x, w, t -> states and outputs by name, all of them

    `symbol` is what both are written in. `solvers` are the quadratic programs they call. ValueError for equations that
    take or give what the component does not have, and for a solver that is called but not given.
    """
    c = _Component(interface, states, derived)
    outputs = slots(interface, "output")
    begun = {"d": derived.begun, "x": states.begun, "y": outputs.begun}
    start = c.function("initialise", initialise, c.at_start, begun, symbol)
    after = {"x_next": states.join, "y": outputs.join}
    step = c.function("step", sample, c.now | {"w": interface.noise, "t": 1}, after, symbol)
    _check_solvers(interface.name, (start, step), given := tuple(solvers))
    return Kernel(start, step, solvers=given)


def continuous_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    derivative: Equations,
    output: Equations,
    states: Layout,
    derived: Layout = _NONE,
    project: Callable[[Parts], Parts] | None = None,
    symbol: Expression = ca.SX,
) -> Kernel:
    """The kernel of a component that is integrated by the Runge-Kutta method of order four.

    initialise  of p, u -> derived values and states by name; what is left out is zero
    derivative  of p, u, d, x -> the states' time derivatives by name
    output      of p, u, d, x -> outputs by name
    project     states -> states, put right after every step (the length of a quaternion)

    `symbol` is what `initialise` is written in; the others are in SX and stay one function each in the C code.
    """
    c = _Component(interface, states, derived)
    rate = c.function("derivative", derivative, c.now, {"x_dot": states.join}, cse=True)
    p, d, u, x = (ca.MX.sym(name, rate.numel_in(name)) for name in c.now)
    h = ca.MX.sym("h")
    k_1, k_2, k_3, k_4 = stages(lambda state, _: rate(p, d, u, state), x, h)
    after = x + h / 6 * (k_1 + 2 * (k_2 + k_3) + k_4)
    if project is not None:
        after = c.function("project", project, {"x": states}, {"x_next": states.join})(after)
    step = ca.Function("step", [p, d, u, x, h], [after], ["p", "d", "u", "x", "h"], ["x_next"])
    return replace(c.moving(initialise, step, output, symbol), derivative=rate)


def exact_kernel(
    interface: Interface,
    *,
    initialise: Equations,
    step: Equations,
    output: Equations,
    states: Layout,
    derived: Layout = _NONE,
) -> Kernel:
    """The kernel of a continuous component whose motion under held inputs is known in closed form.

    step  of p, u, d, x, h -> states by name after h [s]

    The rest is as for `continuous_kernel`.
    """
    c = _Component(interface, states, derived)
    return c.moving(initialise, c.function("step", step, c.now | {"h": 1}, {"x_next": states.join}), output, ca.SX)


@dataclass(frozen=True, slots=True)
class _Component:
    """A component whose functions are made."""

    interface: Interface
    states: Layout
    derived: Layout

    @property
    def at_start(self) -> dict[str, Shape]:
        """Arguments of `initialise`."""
        table = self.interface.table
        rows = (len(table.columns), table.rows) if table else 0
        return {**self._ports, "w": self.interface.noise, "table": rows, "rows": 1}

    @property
    def now(self) -> dict[str, Shape]:
        """Arguments that every later function has."""
        p, u = self._ports.items()
        return dict([p, ("d", self.derived), u, ("x", self.states)])

    @property
    def _ports(self) -> dict[str, Shape]:
        return {"p": slots(self.interface, "parameter"), "u": slots(self.interface, "input")}

    def function(
        self,
        name: str,
        equations: Equations,
        arguments: Mapping[str, Shape],
        results: Mapping[str, Callable[[Parts], Any]],
        symbol: Expression = ca.SX,
        cse: bool = False,
    ) -> ca.Function:
        """The equations as a function of all `arguments`; each of `results` makes a column of what they give.

        With `cse` what they compute twice is computed once, for which CasADi puts them together anew: the last bits may
        change.
        """
        columns, seen = symbols(arguments, symbol)
        has = [key for key, column in columns.items() if column.numel()]
        asked = signature(equations).parameters
        if asked.keys() - set(has):
            lacking = sorted(asked.keys() - set(has))
            raise ValueError(f"{self.interface.name}: {name} takes {lacking}, but there are only {has}")
        found = equations(**{key: seen[key] for key in asked})
        try:
            joined = [join(part) for join, part in zip(results.values(), several(found), strict=True)]
        except ValueError as error:
            raise ValueError(f"{self.interface.name}: {name} gives {error}") from error
        expressions = [symbol(column) for column in joined]
        return ca.Function(
            name, list(columns.values()), ca.cse(expressions) if cse else expressions, list(columns), list(results)
        )

    def moving(self, initialise: Equations, step: ca.Function, output: Equations, symbol: Expression) -> Kernel:
        """The kernel of a continuous component with this step; its first outputs are those of `output`."""
        begun = {"d": self.derived.begun, "x": self.states.begun}
        start = self.function("start", initialise, self.at_start, begun, symbol)
        tell = self.function("output", output, self.now, {"y": slots(self.interface, "output").join}, cse=True)
        p, u, *rest = (symbol.sym(key, *start.size_in(key)) for key in self.at_start)
        d, x = start(p, u, *rest)
        names = [*self.at_start], ["d", "x", "y"]
        first = ca.Function("initialise", [p, u, *rest], [d, x, tell(p, d, u, x)], *names)
        return Kernel(first, step, tell)


def _check_solvers(owner: str, functions: Iterable[ca.Function], solvers: tuple[QpSolver, ...]) -> None:
    given = [solver.function.name() for solver in solvers]
    called = {inner.name() for f in functions for inner in f.find_functions() if inner.class_name() == "External"}
    twice = sorted({name for name in given if given.count(name) > 1})
    if twice or called - set(given):
        raise ValueError(f"{owner}: solvers given twice {twice}, called but not given {sorted(called - set(given))}")
