"""The page of pictures of a run: the path on top, panels over time beneath, two a row."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cosim.results.reading import Results

Panel = Callable[[Results, Any], None]
"""Draws some of the results into matplotlib's axes."""
_ROW = 3.6  # inches
_MOST_POINTS = 4000


def draw_page(
    results: Results, file: Path, title: str, path: Panel, panels: Sequence[Panel], *, path_rows: int = 1
) -> None:
    """Draw and save to `file`; the path is as high as `path_rows` rows of panels."""
    rows = path_rows + (len(panels) + 1) // 2
    figure = Figure(figsize=(16, _ROW * rows), layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(title)
    grid = figure.add_gridspec(rows, 2)
    path(results, figure.add_subplot(grid[:path_rows, :]))
    for i, panel in enumerate(panels):
        axes = figure.add_subplot(grid[path_rows + i // 2, i % 2])
        panel(results, axes)
        axes.set_xlabel("time [s]")
        axes.grid(alpha=0.3)
        axes.margins(y=0.2)
        axes.legend(loc="upper right", ncols=4, fontsize="small")
    figure.savefig(file, dpi=80)


def plot(results: Results, axes: Any, name: str, label: str, scale: float = 1.0, **style: Any) -> None:
    """One signal over time, times `scale`."""
    rows = thinned(np.arange(len(results.time)))
    axes.plot(results.time[rows], scale * results[name][rows], label=label, **style)


def thinned(rows: np.ndarray) -> np.ndarray:
    """At most _MOST_POINTS of the rows: more cannot be seen and take long to draw."""
    return rows[:: max(1, len(rows) // _MOST_POINTS)]
