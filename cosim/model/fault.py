"""Faults: while they last, an instance takes another value of an input than it would."""

from __future__ import annotations

import math
import operator
import re
from collections.abc import Callable
from dataclasses import dataclass

from cosim.errors import CosimError
from cosim.model.effects import Effect

_COMPARED: dict[str, Callable[[float, float], bool]] = {
    ">=": operator.ge,
    "<=": operator.le,
    "==": operator.eq,
    "!=": operator.ne,
    ">": operator.gt,
    "<": operator.lt,
}


@dataclass(frozen=True, slots=True)
class Comparison:
    """`signal`, an `instance.variable` that is recorded, compared with a number."""

    signal: str
    sign: str
    number: float

    def holds(self, value: float) -> bool:
        """Whether it does where the signal has this value."""
        return _COMPARED[self.sign](value, self.number)


def comparisons(text: str) -> tuple[Comparison, ...]:
    """Those of "plant.yaw_rate > 0.2 and filter.x < 5", all of which have to hold; raises CosimError."""
    return tuple(_comparison(part) for part in re.split(r"\s+and\s+", text.strip()) if part)


def _comparison(text: str) -> Comparison:
    found = re.fullmatch(r"\s*(\S+)\s*(>=|<=|==|!=|>|<)\s*(\S+)\s*", text)
    try:
        number = float(found[3]) if found else math.nan
    except ValueError:
        number = math.nan
    if found is None or math.isnan(number):
        raise CosimError(f"cannot read the condition {text!r}; write instance.variable > number, joined by and")
    return Comparison(found[1], found[2], number)


@dataclass(frozen=True, slots=True)
class Fault:
    """From `begin` to `end` [s], while all comparisons of `when` hold, `effect` decides what the input takes.

    `signal` is an `instance.variable`, connected or not, or a pattern of such.
    """

    signal: str
    effect: Effect
    begin: float = 0.0
    end: float = math.inf
    when: tuple[Comparison, ...] = ()

    @property
    def condition(self) -> str:
        """The comparisons as `comparisons` reads them."""
        return " and ".join(f"{each.signal} {each.sign} {each.number!r}" for each in self.when)

    def __post_init__(self) -> None:
        if not (0.0 <= self.begin < self.end) or math.isinf(self.begin):
            raise CosimError(
                f"the event on {self.signal} lasts from {self.begin:g} to {self.end:g} s; give 0 <= time < until"
            )
