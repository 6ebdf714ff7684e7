"""What is shown of a run that has ended."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path

from rich.console import Console
from rich.markup import escape
from rich.table import Table

from cosim.engine.outcome import Status
from cosim.results.summary import Summary
from cosim.scenario.limit import Verdict
from cosim.scenario.metric import Metric
from fmukit.console import console_of

_OF_ONE = re.compile(r"([a-z]+\d+)\.(.+)")
"""Metrics of one of many vehicles, such as car3.formation_error_rms."""
_STYLES: dict[Status, str] = {"ok": "green", "missed": "bold red", "failed": "bold red", "interrupted": "yellow"}
_KEPT = {True: ("green", "no"), False: ("bold red", "yes"), None: ("dim", "not known")}
"""Whether what a limit is named after has happened."""
_LEAST = 7
"""Characters that a column needs for its values."""


def show(summary: Summary, folder: Path) -> None:
    """The metrics, what the run cost, and where the results are."""
    console = console_of()
    style = _STYLES[summary.status]
    console.print(f"{summary.scenario}, seed {summary.seed}: [{style}]{summary.status}[/]")
    if summary.reason:
        console.print(summary.reason, style=style, markup=False, soft_wrap=True)
    if summary.limits:
        console.print(_limits(summary.limits))
    of_all = {name: metric for name, metric in summary.metrics.items() if not _OF_ONE.fullmatch(name)}
    if of_all:
        console.print(_one_per_row(of_all))
    _show_vehicles(console, summary.metrics)
    if summary.pace is not None:
        pace = summary.pace
        console.print(
            f"{pace.overruns} of {pace.ticks} ticks began more than 1 ms late, the worst by {pace.latest * 1e3:.1f} ms"
        )
    speed = f"{summary.wall_time:.2f} s for {summary.stop_time:g} s, {summary.real_time_factor:.1f} x real time"
    console.print(f"ran in {speed}; results in {folder}", soft_wrap=True, markup=False)


def _limits(verdicts: Sequence[Verdict]) -> Table:
    table = Table(header_style="bold")
    for heading in ("limit", "", "seen and allowed"):
        table.add_column(heading)
    for verdict in sorted(verdicts, key=lambda verdict: verdict.kept is not False):
        style, word = _KEPT[verdict.kept]
        table.add_row(verdict.limit.words, f"[{style}]{word}[/]", escape(verdict.text))
    return table


def _one_per_row(metrics: Mapping[str, Metric]) -> Table:
    table = Table(header_style="bold")
    table.add_column("metric")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for name, metric in metrics.items():
        table.add_row(name, *_readable(metric))
    return table


def _show_vehicles(console: Console, metrics: Mapping[str, Metric]) -> None:
    """One vehicle per row, as many of its metrics as there is room for."""
    vehicles: dict[str, dict[str, Metric]] = {}
    for name, metric in metrics.items():
        found = _OF_ONE.fullmatch(name)
        if found:
            vehicles.setdefault(found[1], {})[found[2]] = metric
    columns = list(dict.fromkeys(name for own in vehicles.values() for name in own))
    shown = _fitting(columns, console.width - max(map(len, vehicles), default=0) - 4)
    if not shown:
        return
    table = Table("", header_style="bold")
    for name in shown:
        unit = next(_readable(own[name])[1] for own in vehicles.values() if name in own)
        table.add_column("\n".join([*name.split("_"), f"[{unit}]" if unit else ""]), justify="right")
    for vehicle, own in vehicles.items():
        table.add_row(vehicle, *(_readable(own[name])[0] if name in own else "" for name in shown))
    console.print(table, markup=False)
    left = len(columns) - len(shown)
    if left:
        console.print(f"{left} more of each vehicle in summary.json")


def _fitting(names: list[str], width: int) -> list[str]:
    """The first names whose columns fit; a name is broken at its underscores."""
    fitting = []
    for name in names:
        width -= max(_LEAST, *map(len, name.split("_"))) + 3
        if width < 0:
            break
        fitting.append(name)
    return fitting


def _readable(metric: Metric) -> tuple[str, str]:
    """Angles in degrees for the reader; the files keep SI."""
    value, unit, digits = metric.value, "" if metric.unit == "1" else metric.unit, 4
    if not math.isfinite(value):
        return "-", unit
    if metric.words:
        return metric.words[int(value)], unit
    if unit == "rad":
        value, unit, digits = math.degrees(value), "deg", 3
    return f"{value:.{0 if metric.whole else digits}f}", unit
