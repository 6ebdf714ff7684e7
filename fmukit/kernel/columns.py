"""Columns of numbers and the names of their parts."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import accumulate, pairwise
from typing import Any

import casadi as ca

Parts = dict[str, Any]
"""Parts of a column by name: columns themselves, or `Parts` again where the layout is nested."""


class Layout:
    """Named slices of a column, each given by its length or by a layout of its own, e.g. Layout(place=2, pair=PAIR).

    `sizes` are the lengths by name, `size` is that of the whole column.
    """

    def __init__(self, **slices: int | Layout) -> None:
        self._inner = {name: inner for name, inner in slices.items() if isinstance(inner, Layout)}
        self.sizes: dict[str, int] = {
            name: part.size if isinstance(part, Layout) else part for name, part in slices.items()
        }
        self.size: int = sum(self.sizes.values())

    def symbol(self, name: str = "x") -> ca.SX:
        """A fresh SX symbol of the whole column."""
        return ca.SX.sym(name, self.size)

    def split(self, column: Any) -> Any:
        """The `Parts` of a column (SX, MX or DM)."""
        ends = list(accumulate(self.sizes.values(), initial=0))
        slices = {name: column[a:b] for name, (a, b) in zip(self.sizes, pairwise(ends), strict=True)}
        return slices | {name: inner.split(slices[name]) for name, inner in self._inner.items()}

    def join(self, parts: Any) -> Any:
        """The column of all parts; a column, of this layout or in place of a nested part, is taken as it is.

        ValueError for unknown or missing names and for columns of another length.
        """
        if not isinstance(parts, dict):
            return _of_length(self.size, parts, "the column")
        unknown, missing = parts.keys() - self.sizes.keys(), self.sizes.keys() - parts.keys()
        if unknown or missing:
            raise ValueError(f"unknown values {sorted(unknown)}, missing values {sorted(missing)}")
        whole = parts | {name: inner.join(parts[name]) for name, inner in self._inner.items()}
        return ca.vertcat(*(_of_length(size, whole[name], name) for name, size in self.sizes.items()))

    def begun(self, parts: Any) -> Any:
        """`join` with zeros for parts that are not given."""
        zeros = {name: ca.DM.zeros(size) for name, size in self.sizes.items()}
        return self.join(zeros | parts if isinstance(parts, dict) else parts)


def _of_length(size: int, column: Any, name: str) -> Any:
    length = ca.vertcat(column).numel()
    if length != size:
        raise ValueError(f"{name} has {length} elements, not {size}")
    return column


class Slots(Layout):
    """The scalars of an interface in slot order: a layout whose parts are seen as `Signals`."""

    def __init__(self, names: Iterable[str]) -> None:
        super().__init__(**dict.fromkeys(names, 1))

    def split(self, column: Any) -> Signals:
        """The scalars of the column by name."""
        return Signals(self.sizes, column)


class Signals:
    """Scalars by name over one column: s["mass"], s.vector("position", "xyz"); unknown names raise KeyError.

    `column` is all of them.
    """

    def __init__(self, names: Iterable[str], column: Any) -> None:
        self.column = column
        self._index = {name: i for i, name in enumerate(names)}

    def __getitem__(self, name: str) -> Any:
        return self.column[self._index[name]]

    def vector(self, name: str, members: Iterable[str]) -> Any:
        """The column of name.member for each member."""
        return self.pick(f"{name}.{member}" for member in members)

    def pick(self, names: Iterable[str]) -> Any:
        """The column of these scalars."""
        return self.column[[self._index[name] for name in names]]

    def over(self, column: Any) -> Signals:
        """The same names over another column."""
        return Signals(self._index, column)


def named(group: str, members: Iterable[str], values: Any) -> Parts:
    """The values of a column or of an iterable as group.member, in the order of the members."""
    column = ca.vertsplit(values) if hasattr(values, "numel") else values
    return {f"{group}.{member}": value for member, value in zip(members, column, strict=True)}


def choose(condition: Any, chosen: Parts, other: Parts) -> Parts:
    """Part by part `chosen` where the scalar condition holds, else the part of that name in `other`."""
    return {
        name: choose(condition, part, other[name])
        if isinstance(part, dict)
        else ca.if_else(condition, part, other[name])
        for name, part in chosen.items()
    }
