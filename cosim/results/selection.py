"""Some signals of a run, and some of its rows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cosim.errors import CosimError, unknown
from cosim.model.patterns import is_pattern, matches
from cosim.results.reading import Results

ROUNDING = 1e-9
"""Two times [s] nearer than that are one."""


def signals(results: Results, patterns: Sequence[str]) -> list[str]:
    """The names that fit any of the patterns, in the order of the columns; all without a pattern.

    Raises CosimError for a pattern or a name that nothing fits.
    """
    if not patterns:
        return list(results.names)
    fitting = {pattern: [name for name in results.names if matches(name, pattern)] for pattern in patterns}
    for pattern, found in fitting.items():
        if not found and is_pattern(pattern):
            raise CosimError(f"no signal fits the pattern {pattern!r}; the columns of results.parquet are the signals")
        if not found:
            raise unknown("signal", pattern, results.names, "the columns of results.parquet are the signals")
    chosen = {name for found in fitting.values() for name in found}
    return [name for name in results.names if name in chosen]


def rows(time: np.ndarray, every: float) -> np.ndarray:
    """The rows nearest after each multiple of `every` [s], and the last one; all rows where it is 0."""
    if not (np.isfinite(every) and every >= 0.0):
        raise CosimError(f"the time between two rows is {every:g} s; it must be finite and not negative")
    if every == 0.0 or len(time) < 2:
        return np.arange(len(time))
    passed = np.floor((time - time[0] + ROUNDING) / every)
    first = np.append(True, np.diff(passed) > 0)
    return np.flatnonzero(first | (np.arange(len(time)) == len(time) - 1))
