"""Two runs held against each other, signal by signal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cosim.errors import CosimError
from cosim.results.reading import Results
from cosim.results.selection import ROUNDING, signals


@dataclass(frozen=True, slots=True)
class Difference:
    """The largest difference of one signal, `at` a time [s]; `relative` to the larger of its two ranges, or to 1."""

    signal: str
    unit: str
    largest: float
    at: float
    relative: float


@dataclass(frozen=True, slots=True)
class Comparison:
    """Differences, the largest first, and the names of signals that only one run has."""

    differences: Sequence[Difference]
    only_first: Sequence[str]
    only_second: Sequence[str]

    def beyond(self, tolerance: float) -> list[Difference]:
        """Those of more than `tolerance` relative to the range of the signal."""
        return [each for each in self.differences if not each.relative <= tolerance]


def compare(first: Results, second: Results, patterns: Sequence[str] = ()) -> Comparison:
    """Over the time that both have, the second on straight lines between its rows; raises CosimError for none.

    NaN equals NaN, and differs from every number by infinity.
    """
    names = signals(first, patterns)
    both = [name for name in names if name in second]
    begin, end = max(first.time[0], second.time[0]), min(first.time[-1], second.time[-1])
    shared = (first.time >= begin - ROUNDING) & (first.time <= end + ROUNDING)
    if not shared.any():
        raise CosimError("the two runs have no time in common")
    differences = [_difference(name, first, second, shared) for name in both]
    return Comparison(
        sorted(differences, key=lambda each: -each.relative),
        [name for name in names if name not in second],
        [name for name in second.names if name not in first],
    )


def _difference(name: str, first: Results, second: Results, shared: np.ndarray) -> Difference:
    time = first.time[shared]
    if "O" in (first[name].dtype.kind, second[name].dtype.kind):
        return _of_texts(name, first, second, shared)
    one, other = np.asarray(first[name][shared], float), _at(time, second, name)
    with np.errstate(invalid="ignore"):
        apart = np.where(one == other, 0.0, np.abs(one - other))  # equal infinities, too
    apart[np.isnan(one) & np.isnan(other)] = 0.0
    apart[np.isnan(apart)] = np.inf
    worst = int(np.argmax(apart))
    largest = float(apart[worst])
    reach = max(_range(one), _range(other)) or 1.0
    return Difference(name, first.unit(name), largest, float(time[worst]), largest / reach)


def _of_texts(name: str, first: Results, second: Results, shared: np.ndarray) -> Difference:
    """Texts are equal or not; the text of the second run is that of its last row until then."""
    time = first.time[shared]
    place = np.clip(np.searchsorted(second.time, time + ROUNDING) - 1, 0, len(second.time) - 1)
    other = np.flatnonzero(first[name][shared] != second[name][place])
    apart = np.inf if len(other) else 0.0
    return Difference(name, "", apart, float(time[other[0]]) if len(other) else float(time[0]), apart)


def _at(time: np.ndarray, results: Results, name: str) -> np.ndarray:
    """The values at these times, those of its own rows unchanged."""
    values = np.asarray(results[name], float)
    place = np.clip(np.searchsorted(results.time, time - ROUNDING), 0, len(results.time) - 1)
    same = np.abs(results.time[place] - time) <= ROUNDING
    return np.where(same, values[place], np.interp(time, results.time, values))


def _range(values: np.ndarray) -> float:
    finite = values[np.isfinite(values)]
    return float(np.ptp(finite)) if len(finite) else 0.0
