"""What the command line shows: progress, tables. Everything that is not a result goes to stderr."""

from __future__ import annotations

import logging
import math
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from rich.table import Table

from cosim.model.clock import to_seconds
from cosim.run import Plan
from cosim.scenario import Scenario
from fmukit.console import console_of

_UNITS = {
    **dict.fromkeys(("lateral_", "longitudinal_", "position_", "corridor_"), "m"),
    **dict.fromkeys(("clearance_", "distance_", "last_point_", "road_margin_", "stop_distance"), "m"),
    **{"speed_": "m/s", "impact_speed": "m/s", "saturation_": "s", "final_time": "s", "first_action": "s"},
    **{"optimum_time": "s", "planned_ahead_": "s", "joint_position_": "m", "joint_speed_": "m/s"},
    **{"residual_force": "N", "residual_moment": "N.m"},
    **dict.fromkeys(("formation_error_", "place_error_", "change_error_", "push_error_"), "m"),
    **{
        "settling_": "s",
        "led_back_": "s",
        "speed_ratio_": "",
        "acceleration_": "m/s2",
        "lateral_acceleration_": "m/s2",
    },
}
"""Units of metrics by how their names begin, the longest that fits, after the name of a car (`car2.settling_time`)."""
_CAR = re.compile(r"car\d+\.")
_REFRESH = 0.1  # [s] of wall time between two updates of the progress bar


class _Notices(logging.Handler):
    """One line on whatever stderr is at the time."""

    def emit(self, record: logging.LogRecord) -> None:
        print(f"cosim: {record.getMessage()}", file=sys.stderr)


def notices(*, shown: bool) -> None:
    """Send what is worth a sentence, such as a plan being made, to stderr, or nowhere."""
    log = logging.getLogger("cosim")
    log.handlers = [_Notices()] if shown else [logging.NullHandler()]
    log.setLevel(logging.INFO)


def silent(_plan: Plan) -> None:
    """The explainer that says nothing."""


def explainer(*, to_stderr: bool) -> Callable[[Plan], None]:
    """Prints the explanation of a plan."""
    from cosim.command.explain import explanation  # noqa: PLC0415  (only with --explain)

    def explain(plan: Plan) -> None:
        console = console_of(stderr=to_stderr)
        for title, table in explanation(plan):
            console.print(title)
            console.print(table)

    return explain


@contextmanager
def progress(stop: float, *, shown: bool) -> Iterator[Callable[[int], None]]:
    """A progress callback for the master: simulated time and real-time factor, refreshed ten times a second."""
    console = Console(stderr=True)
    if not (shown and console.is_terminal):
        yield lambda _time: None
        return
    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[factor]}"), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True, auto_refresh=False) as bar:
        task = bar.add_task("preparing", total=stop, factor="")
        started = shown_at = 0.0

        def update(time: int) -> None:
            nonlocal started, shown_at
            now = perf_counter()
            started = started or now
            if now - shown_at > _REFRESH:
                shown_at, seconds = now, to_seconds(time)
                factor = seconds / (now - started) if now > started else 0.0
                text = f"{seconds:.2f} of {stop:g} s"
                bar.update(task, completed=seconds, description=text, factor=f"{factor:.1f} x real time", refresh=True)

        bar.refresh()
        yield update


def scenario_table(scenarios: Sequence[Scenario]) -> Table:
    table = Table(header_style="bold")
    table.add_column("scenario", no_wrap=True)
    for column in ("what it is", "reproduces", "settings"):
        table.add_column(column)
    for scenario in scenarios:
        settings = "\n".join(f"{name}={setting.offered}" for name, setting in scenario.settings.items())
        table.add_row(scenario.name, scenario.title, scenario.figures, settings)
    return table


def show(summary: Mapping[str, Any], folder: Path) -> None:
    """The metrics, what the run cost, and where the results are."""
    console = console_of()
    table = Table(header_style="bold")
    table.add_column("metric")
    table.add_column("value", justify="right")
    table.add_column("unit")
    for name, value in summary["metrics"].items():
        table.add_row(name, *_readable(name, value))
    console.print(f"{summary['scenario']}, seed {summary['seed']}: {summary['status']}")
    if table.row_count:
        console.print(table)
    speed = (
        f"{summary['wall_time']:.2f} s for {summary['stop_time']:g} s, {summary['real_time_factor']:.1f} x real time"
    )
    console.print(f"ran in {speed}; results in {folder}", soft_wrap=True, markup=False)


def _readable(name: str, value: float | None) -> tuple[str, str]:
    """Angles in degrees for the reader; the files keep SI."""
    name = _CAR.sub("", name, count=1)
    if name.startswith(("course_", "roll_", "pitch_", "sideslip_", "yaw_", "joint_course_")):
        return "-" if value is None else f"{math.degrees(value):.3f}", "deg"
    begin = max((begin for begin in _UNITS if name.startswith(begin)), key=len, default="")
    return "-" if value is None else f"{value:.4f}", _UNITS.get(begin, "")
