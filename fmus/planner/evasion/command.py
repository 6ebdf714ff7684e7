"""`fmus plan collision-avoidance`: the last points to brake and to steer, computed anew, as a table."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.progress import Progress
from rich.table import Table

from fmukit.console import console_of
from fmukit.errors import UserError
from fmus.planner import files
from fmus.planner.errors import PlanningError
from fmus.planner.evasion import table
from fmus.planner.evasion.situation import Surroundings
from fmus.planner.evasion.table import COLUMNS, LastPointTable

NAME = "collision-avoidance"


def avoidance_command(file: Path | None, given: Sequence[str], *, as_json: bool) -> None:
    """Compute the table, write it to `file` if there is one, and show it; `given` are options that mean nothing here.

    Raises UserError for such an option, or when the table cannot be computed or written.
    """
    if given:
        raise UserError(f"{NAME} is a table of last points, not one plan; leave out {', '.join(given)}")
    road = Surroundings()
    try:
        files.check_outputs([] if file is None else [file])
        with _progress(shown=not as_json) as progress:
            found = table.compute(road, progress=progress)
        if file is not None:
            table.write(found, file)
    except PlanningError as error:
        raise UserError(str(error)) from error
    if as_json:
        print(json.dumps(_data(found, road, file), indent=2))
        return
    _print(found, road, file)


def _data(found: LastPointTable, road: Surroundings, file: Path | None) -> dict[str, Any]:
    rows = [dict(zip(COLUMNS, map(float, row), strict=True)) for row in found.rows]
    return {"surroundings": asdict(road), "last_points": rows, "file": None if file is None else str(file)}


def _print(found: LastPointTable, road: Surroundings, file: Path | None) -> None:
    console = console_of()
    console.print("last points in m: distance of the front bumper from the obstacle when braking or steering begins")
    console.print(_shown(found, road))
    console.print(
        f"the car acts {road.reaction_time:g} s after the obstacle appears; it steers only if {road.reserve:g} times "
        "the last point is left",
        soft_wrap=True,
    )
    if file is not None:
        console.print(f"written to {file}", soft_wrap=True, markup=False)


def _shown(found: LastPointTable, road: Surroundings) -> Table:
    shown = Table(header_style="bold")
    columns = ("friction", "offset", "obstacle", "speed", "brake", "by the car", "steer", "brake and steer", "steering")
    for column in columns:
        shown.add_column(column, justify="right")
    last = None
    for mu, offset, v, brake, by_car, steer, both in found.rows:
        if last not in (None, (mu, offset)):
            shown.add_section()
        last = mu, offset
        width = max(0.0, 2 * (offset - road.clearance) - road.car_width)
        kind = "wins" if steer < brake else "with brakes" if both < brake else "loses"
        shown.add_row(
            *(f"{mu:g}", f"{offset:g}", f"{width:.2f}", f"{v:g}"),
            *(f"{value:.1f}" for value in (brake, by_car, steer, both)),
            kind,
        )
    return shown


@contextmanager
def _progress(*, shown: bool) -> Iterator[Callable[[int, int], None]]:
    """Tells how far the computation is, on a terminal."""
    console = console_of(stderr=True)
    if not (shown and console.is_terminal):
        yield lambda _done, _total: None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("last points", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
