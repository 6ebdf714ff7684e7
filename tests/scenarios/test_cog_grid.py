"""The whole robustness grid: an unknown centre of gravity, controllers and filter with nominal data."""

from __future__ import annotations

import numpy as np
import pytest

NAME = "high-speed-tracking"
ROWS = (-0.2, -0.1, 0.0, 0.1, 0.2)
COLUMNS = ((0.0, 0.0), (0.1, 0.0), (0.0, 0.1), (0.1, 0.1))
SEEDS = range(5)


def mean_of_peaks(scenario_run, offset: tuple[float, float, float], seeds=SEEDS) -> float:
    """Mean over the seeds of the largest lateral error [m] with the total centre of gravity moved by `offset`."""
    assignments = [f"plant.cog_offset.{axis}={value}" for axis, value in zip("xyz", offset, strict=True)]
    return float(
        np.mean([scenario_run(NAME, *assignments, seed=s).summary.metrics["lateral_error_max"].value for s in seeds])
    )


def as_text(table: np.ndarray) -> str:
    """The table in cm, as thesis Table 4.2: a row per shift forward, a column per shift to the left and upward."""
    head = "dx \\ (dy, dz) [m]" + "".join(f"{column!s:>14}" for column in COLUMNS)
    lines = [
        f"{dx:>17.1f}" + "".join(f"{100 * e:>14.1f}" for e in errors) for dx, errors in zip(ROWS, table, strict=True)
    ]
    return "\n".join([head, *lines])


@pytest.mark.nightly
def test_lateral_error_over_the_whole_grid(scenario_run) -> None:
    table = np.array([[mean_of_peaks(scenario_run, (dx, dy, dz)) for dy, dz in COLUMNS] for dx in ROWS])
    print(f"\n{as_text(table)}")
    assert table.max() <= 0.30, as_text(table)
