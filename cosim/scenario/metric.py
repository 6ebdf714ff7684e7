"""A figure that says how good a run was, with its unit."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple


class Metric(NamedTuple):
    """`value` in SI units, NaN where there is nothing to measure; `unit` is "1" for a pure number.

    The value of a `whole` one is a count. That of a choice is the place of a word in `words`: no and yes, for example.
    """

    value: float
    unit: str = "1"
    whole: bool = False
    words: tuple[str, ...] = ()

    @property
    def plain(self) -> float | int | bool | str | None:
        """As JSON has it: a count is an integer, a choice its word, what is not known null."""
        if not math.isfinite(self.value):
            return None
        if self.words == NO_YES:
            return bool(self.value)
        if self.words:
            return self.words[int(self.value)]
        return int(self.value) if self.whole else float(self.value)


Metrics = Mapping[str, Metric]
"""Metrics by name."""
NO_YES = ("no", "yes")


def in_unit(unit: str, values: Mapping[str, float]) -> dict[str, Metric]:
    """The `values` as metrics of one unit."""
    return {name: Metric(value, unit) for name, value in values.items()}


def count(value: float) -> Metric:
    """How many there were, or NaN."""
    return Metric(value, whole=True)


def truth(value: float) -> Metric:
    """Whether something happened: 0, 1 or NaN."""
    return Metric(float(value), words=NO_YES)


def choice(place: int, words: Sequence[str]) -> Metric:
    """What was decided: the word at that place."""
    return Metric(float(place), words=tuple(words))
