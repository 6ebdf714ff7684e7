"""Figures held against an aim leave nothing out."""

from __future__ import annotations

import numpy as np
import pytest

from benchmarks.spread import microseconds, spread


def test_an_outlier_of_one_round_counts_in_mean_and_worst_but_not_in_the_best() -> None:
    seen = spread([np.array([1.0, 2.0, 3.0]), np.array([1.0, 92.0, 2.0]), np.array([1.5, 2.0, 4.5])])
    assert seen.mean == pytest.approx(109.0 / 9.0)
    assert seen.worst == 92.0
    assert seen.best_mean == pytest.approx(5.0 / 3.0)
    assert seen.best_worst == 2.0
    assert microseconds(seen, 3) == "mean; worst 92.0 us; best of 3: mean 1.7, worst 2.0"


def test_what_is_slow_in_every_round_is_the_worst_of_the_best_too() -> None:
    seen = spread(np.array([[7.0, 1.0], [6.0, 1.0]]))
    assert (seen.worst, seen.best_worst) == (7.0, 6.0)


def test_rounds_of_different_work_are_refused() -> None:
    with pytest.raises(ValueError, match="inhomogeneous"):
        spread([np.ones(3), np.ones(2)])
