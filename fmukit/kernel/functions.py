"""From equations, which are plain Python functions of symbols, to CasADi functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import Any

import casadi as ca

from fmukit.interface import Causality, Interface
from fmukit.kernel.columns import Layout, Signals, Slots

Shape = int | tuple[int, int] | ca.Sparsity | Layout
"""Of an argument: length of a column, rows and columns or pattern of a matrix, or the layout equations see it by."""
Expression = Any
"""What equations are written in: `casadi.SX` or `casadi.MX`."""


def slots(interface: Interface, causality: Causality) -> Slots:
    """The scalars of one causality, which equations see as `Signals`; of the outputs all but `fault`."""
    return Slots(interface.names(causality))


def block(symbol: Expression = ca.SX, **arguments: Shape) -> Callable[[Callable[..., Any]], Block]:
    """Decorate equations to be a `Block` of the arguments named, in this order.

    @block(p=slots(INTERFACE, "parameter"), x=STATES, T=1)
    def later(p: Signals, x: Parts, T: ca.SX) -> Parts: ...
    """
    return lambda equations: Block(equations, arguments, symbol)


class Block:
    """Equations that stay one function where others call them: in the graph, and in the generated C code.

    It is called as the equations are, with the same kinds of arguments and results, from SX and from MX. `function`
    is the CasADi function itself, of columns and matrices; it is made when it is first needed.
    """

    def __init__(self, equations: Callable[..., Any], arguments: Mapping[str, Shape], symbol: Expression) -> None:
        self._equations, self._arguments, self._symbol = equations, arguments, symbol

    def __call__(self, *arguments: Any) -> Any:
        shapes = self._arguments.values()
        given = [_column(argument, shape) for argument, shape in zip(arguments, shapes, strict=True)]
        function, layouts = self._made
        found = function.call(given)
        results = [layout.split(r) if layout else r for r, layout in zip(found, layouts, strict=True)]
        return tuple(results) if len(results) > 1 else results[0]

    @property
    def function(self) -> ca.Function:
        """The function of columns and matrices, in the order of the arguments."""
        return self._made[0]

    @cached_property
    def _made(self) -> tuple[ca.Function, list[Layout | None]]:
        """The function, and the layouts of those results that are `Parts`."""
        columns, seen = symbols(self._arguments, self._symbol)
        found = several(self._equations(**seen))
        layouts = [_layout(result) if isinstance(result, dict) else None for result in found]
        results = [layout.join(r) if layout else r for r, layout in zip(found, layouts, strict=True)]
        name = self._equations.__name__.strip("_")
        return ca.Function(name, list(columns.values()), list(map(self._symbol, results))), layouts


def symbols(shapes: Mapping[str, Shape], symbol: Expression) -> tuple[dict[str, Any], dict[str, Any]]:
    """Fresh symbols of these shapes by name, and the same as equations see them."""
    columns = {name: _symbol(name, shape, symbol) for name, shape in shapes.items()}
    seen = {name: shape.split(columns[name]) for name, shape in shapes.items() if isinstance(shape, Layout)}
    return columns, columns | seen


def several(found: Any) -> tuple[Any, ...]:
    """What equations give back, one or several."""
    return tuple(found) if isinstance(found, tuple | list) else (found,)


def _symbol(name: str, shape: Shape, symbol: Expression) -> Any:
    if isinstance(shape, Layout):
        return symbol.sym(name, shape.size)
    return symbol.sym(name, *shape) if isinstance(shape, tuple) else symbol.sym(name, shape)


def _column(argument: Any, shape: Shape) -> Any:
    if isinstance(argument, Signals):
        return argument.column
    return shape.join(argument) if isinstance(shape, Layout) and isinstance(argument, dict) else argument


def _layout(parts: Mapping[str, Any]) -> Layout:
    return Layout(**{name: _layout(part) if isinstance(part, dict) else part.numel() for name, part in parts.items()})
