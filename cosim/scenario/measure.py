"""Measures: metrics that need no code, one number of one signal or of the difference of two."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np

from cosim.scenario.metric import Metric

if TYPE_CHECKING:
    from cosim.model.signals import Vector
    from cosim.results.reading import Results

Statistic = Literal["last", "min", "max", "largest", "mean", "rms"]
"""`largest` is that of the absolute value."""
STATISTICS: tuple[str, ...] = get_args(Statistic)
_COMPUTED: Mapping[str, Callable[[Vector], float]] = {
    "last": lambda values: float(values[-1]),
    "min": lambda values: float(values.min()),
    "max": lambda values: float(values.max()),
    "largest": lambda values: float(np.abs(values).max()),
    "mean": lambda values: float(values.mean()),
    "rms": lambda values: float(np.sqrt(np.mean(values**2))),
}


@dataclass(frozen=True, slots=True)
class Measure:
    """The statistic `of` a signal, or of its difference from the signal `minus`, from the time `after` [s] on.

    It is taken over the recorded rows, each with the same weight.
    """

    signal: str
    of: Statistic
    minus: str | None = None
    after: float = 0.0


def measured(measures: Mapping[str, Measure], results: Results) -> dict[str, Metric]:
    """The metrics by name; NaN where no row is late enough. Raises CosimError for a signal that was not recorded."""
    return {name: Metric(_value(measure, results), results.unit(measure.signal)) for name, measure in measures.items()}


def _value(measure: Measure, results: Results) -> float:
    values = np.asarray(results[measure.signal], float)
    if measure.minus is not None:
        values = values - np.asarray(results[measure.minus], float)
    values = values[results.time >= measure.after]
    return _COMPUTED[measure.of](values) if len(values) else float("nan")
