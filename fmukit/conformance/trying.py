"""Which values and variables to try out: some of many, and near where the FMU is at home."""

from __future__ import annotations

import random
from collections.abc import Iterable

from fmukit.conformance.variable import ScalarVariable

_LARGEST = 1e300


def limits(variable: ScalarVariable) -> tuple[float, float]:
    """The declared min and max, or a large number where there is none."""
    return (
        -_LARGEST if variable.min is None else variable.min,
        _LARGEST if variable.max is None else variable.max,
    )


def first(variables: Iterable[ScalarVariable], most: int) -> tuple[ScalarVariable, ...]:
    """Some of many, the same ones each time, from everywhere in the list."""
    everything = tuple(variables)
    stride = max(1, -(-len(everything) // most))
    return everything[::stride]


def near(variable: ScalarVariable, generator: random.Random) -> float:
    """A value near the start value of a Real variable, inside its limits."""
    start = float(variable.start or 0.0)
    scale = variable.nominal or 0.1 * abs(start) or 0.1
    low, high = limits(variable)
    return min(max(start + 0.1 * scale * generator.uniform(-1.0, 1.0), low), high)
