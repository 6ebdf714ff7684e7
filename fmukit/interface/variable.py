"""One variable of an FMU, and the short ways to declare parameters, inputs and outputs."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Literal

Causality = Literal["parameter", "input", "output"]
Type = Literal["Real", "Integer", "Boolean", "String"]
Value = float | int | bool | str

AXES = ("x", "y", "z")
_NAME = re.compile(r"[a-z_][a-z0-9_]*(\[\d+])?(\.[a-z_][a-z0-9_]*(\[\d+])?)*")


@dataclass(frozen=True, slots=True)
class Variable:
    """One scalar variable. `unit` is "1" for a pure number; `minimum`/`maximum` are inclusive and enforced."""

    name: str
    causality: Causality
    unit: str
    description: str
    start: Value = 0.0
    minimum: float | None = None
    maximum: float | None = None
    nominal: float | None = None
    type: Type = "Real"
    source: str = ""

    def __post_init__(self) -> None:
        if not _NAME.fullmatch(self.name):
            raise ValueError(f"variable name {self.name!r} is not a lower_snake structured name")
        if not self.description:
            raise ValueError(f"variable {self.name} has no description")
        if self.type == "String":
            return
        low = -math.inf if self.minimum is None else self.minimum
        high = math.inf if self.maximum is None else self.maximum
        if not low <= float(self.start) <= high:
            raise ValueError(f"variable {self.name}: start {self.start} is outside [{low}, {high}]")


def parameter(
    name: str,
    unit: str,
    description: str,
    start: Value,
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    source: str = "",
) -> Variable:
    """A fixed parameter; a bool start makes it Boolean, a str start makes it String."""
    type_: Type = "Boolean" if isinstance(start, bool) else "String" if isinstance(start, str) else "Real"
    return Variable(name, "parameter", unit, description, start, minimum, maximum, type=type_, source=source)


def input_(
    name: str,
    unit: str,
    description: str,
    start: float = 0.0,
    *,
    minimum: float | None = None,
    maximum: float | None = None,
    nominal: float | None = None,
) -> Variable:
    """A Real input."""
    return Variable(name, "input", unit, description, start, minimum, maximum, nominal)


def output(name: str, unit: str, description: str, *, nominal: float | None = None) -> Variable:
    """A Real output; its value after initialisation is calculated."""
    return Variable(name, "output", unit, description, nominal=nominal)


def group(
    make: Callable[..., Variable], name: str, members: Iterable[str], unit: str, text: str, **options: object
) -> list[Variable]:
    """`make` (`input_`, `output`) once per member: group(input_, "force", AXES, "N", "external force")."""
    return [make(f"{name}.{member}", unit, f"{text}, {member}", **options) for member in members]
