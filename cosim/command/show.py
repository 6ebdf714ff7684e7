"""What is shown of a run that has ended."""

from __future__ import annotations

import math
from pathlib import Path

from rich.table import Table

from cosim.results.summary import Summary
from cosim.scenario.metric import Metric
from fmukit.console import console_of


def show(summary: Summary, folder: Path) -> None:
    """The metrics, what the run cost, and where the results are."""
    console = console_of()
    table = Table(header_style="bold")
    table.add_column("metric")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for name, metric in summary.metrics.items():
        table.add_row(name, *_readable(metric))
    console.print(f"{summary.scenario}, seed {summary.seed}: {summary.status}")
    if summary.reason:
        console.print(summary.reason, markup=False)
    if table.row_count:
        console.print(table)
    speed = f"{summary.wall_time:.2f} s for {summary.stop_time:g} s, {summary.real_time_factor:.1f} x real time"
    console.print(f"ran in {speed}; results in {folder}", soft_wrap=True, markup=False)


def _readable(metric: Metric) -> tuple[str, str]:
    """Angles in degrees for the reader; the files keep SI."""
    value, unit, digits = metric.value, "" if metric.unit == "1" else metric.unit, 4
    if unit == "rad":
        value, unit, digits = math.degrees(value), "deg", 3
    return f"{value:.{digits}f}" if math.isfinite(value) else "-", unit
