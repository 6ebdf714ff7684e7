"""What an FMU computes: pure CasADi functions over the slots of an `Interface`, and the helpers to write them.

All arguments are dense columns of doubles in slot order:
    p parameters, u inputs, y outputs (without `fault`), d values derived once from the parameters,
    x states, w unit normals, t time since the start of the sampling grid [s], h substep length [s],
    table the rows of the CSV file as a (columns x capacity) matrix, rows their number (0: no file).
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import casadi as ca

from fmukit.component import Component
from fmukit.interface import Causality, Interface

if TYPE_CHECKING:
    from fmukit.qp.solver import QpSolver

__all__ = [
    "Component",
    "Kernel",
    "Layout",
    "Signals",
    "continuous_kernel",
    "sampled_kernel",
    "stack",
    "symbols",
]

Column = TypeVar("Column", ca.SX, ca.MX)


@dataclass(frozen=True, slots=True)
class Kernel:
    """The functions of one component.

    initialise  (p, u, w, table, rows) -> (d, x, y)
    step        sampled:    (p, d, u, x, w, t) -> (x, y)
                continuous: (p, d, u, x, h) -> (x), one substep
    output      continuous only: (p, d, u, x) -> (y)
    solvers     the quadratic programs the functions call
    """

    initialise: ca.Function
    step: ca.Function
    output: ca.Function | None = None
    solvers: tuple[QpSolver, ...] = ()


class Signals:
    """Scalars of one causality by name, over one symbolic column: s["mass"], s.vector("position", "xyz")."""

    def __init__(self, names: Iterable[str], column: ca.SX) -> None:
        self.column = column
        self._index = {name: i for i, name in enumerate(names)}

    def __getitem__(self, name: str) -> ca.SX:
        return self.column[self._index[name]]

    def vector(self, name: str, members: Iterable[str]) -> ca.SX:
        """The column of name.member for each member."""
        return ca.vertcat(*(self[f"{name}.{member}"] for member in members))


def symbols(interface: Interface, causality: Causality) -> Signals:
    """Fresh SX symbols for all parameters, inputs or outputs."""
    names = interface.names(causality)
    return Signals(names, ca.SX.sym(causality[0] if causality != "input" else "u", len(names)))


def stack(names: Iterable[str], values: Mapping[str, Column]) -> Column:
    """The column of `values` in the order of `names`; unknown or missing names raise ValueError."""
    names = tuple(names)
    unknown, missing = values.keys() - set(names), set(names) - values.keys()
    if unknown or missing:
        raise ValueError(f"unknown values {sorted(unknown)}, missing values {sorted(missing)}")
    return ca.vertcat(*(values[name] for name in names))


class Layout:
    """Named slices of a column, e.g. Layout(position=3, attitude=4): the states of a component."""

    def __init__(self, **sizes: int) -> None:
        self.sizes = sizes
        self.size = sum(sizes.values())

    def symbol(self, name: str = "x") -> ca.SX:
        """A fresh symbol of the whole column."""
        return ca.SX.sym(name, self.size)

    def split(self, column: Column) -> dict[str, Column]:
        """The slices of the column by name."""
        parts, start = {}, 0
        for name, size in self.sizes.items():
            parts[name] = column[start : start + size]
            start += size
        return parts

    def join(self, parts: Mapping[str, Column]) -> Column:
        """The column of all slices; unknown or missing names and wrong sizes raise ValueError."""
        for name, size in self.sizes.items():
            if name in parts and parts[name].numel() != size:
                raise ValueError(f"state {name} has {parts[name].numel()} elements, not {size}")
        return stack(self.sizes, parts)


def sampled_kernel(
    interface: Interface,
    *,
    states: Layout,
    derived: Layout,
    initialise: ca.Function,
    step: ca.Function,
    solvers: Iterable[QpSolver] = (),
) -> Kernel:
    """Check the sizes of a sampled component's functions against its interface and give them as a `Kernel`.

    `solvers` are the quadratic programs its functions call; ValueError names one that is called but not given.
    """
    sizes = _sizes(interface)
    p, u, y, w, table = (sizes[key] for key in ("p", "u", "y", "w", "table"))
    _expect(interface.name, initialise, (p, u, w, table, 1), (derived.size, states.size, y))
    _expect(interface.name, step, (p, derived.size, u, states.size, w, 1), (states.size, y))
    given = tuple(solvers)
    _expect_solvers(interface.name, (initialise, step), given)
    return Kernel(initialise, step, solvers=given)


def continuous_kernel(
    interface: Interface,
    *,
    states: Layout,
    derived: Layout,
    initialise: ca.Function,
    step: ca.Function,
    output: ca.Function,
) -> Kernel:
    """Check the sizes of a continuous component's functions against its interface and give them as a `Kernel`."""
    sizes = _sizes(interface)
    p, u, y = sizes["p"], sizes["u"], sizes["y"]
    _expect(interface.name, initialise, (p, u, 0, 0, 1), (derived.size, states.size, y))
    _expect(interface.name, step, (p, derived.size, u, states.size, 1), (states.size,))
    _expect(interface.name, output, (p, derived.size, u, states.size), (y,))
    return Kernel(initialise, step, output)


def _sizes(interface: Interface) -> dict[str, int]:
    table = interface.table
    return {
        "p": len(interface.names("parameter")),
        "u": len(interface.names("input")),
        "y": len(interface.names("output")),
        "w": interface.noise,
        "table": len(table.columns) * table.rows if table else 0,
    }


def _expect_solvers(owner: str, functions: Iterable[ca.Function], solvers: tuple[QpSolver, ...]) -> None:
    given = [solver.function.name() for solver in solvers]
    called = {inner.name() for f in functions for inner in f.find_functions() if inner.class_name() == "External"}
    twice = sorted({name for name in given if given.count(name) > 1})
    if twice or called - set(given):
        raise ValueError(f"{owner}: solvers given twice {twice}, called but not given {sorted(called - set(given))}")


def _expect(owner: str, function: ca.Function, inputs: tuple[int, ...], outputs: tuple[int, ...]) -> None:
    seen_in = tuple(function.numel_in(i) for i in range(function.n_in()))
    seen_out = tuple(function.numel_out(i) for i in range(function.n_out()))
    if (seen_in, seen_out) != (inputs, outputs):
        raise ValueError(f"{owner}.{function.name()}: sizes {seen_in} -> {seen_out}, expected {inputs} -> {outputs}")
