"""`cosim plan collision-avoidance`: the last points to brake and to steer, computed anew, as a table."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.errors import CosimError

if TYPE_CHECKING:
    from rich.table import Table as RichTable

    from fmus.planner.evasion.situation import Surroundings
    from fmus.planner.evasion.table import Table

NAME = "collision-avoidance"


def avoidance_command(file: Path | None, given: Sequence[str], *, as_json: bool) -> None:
    """Compute the table, write it to `file` if there is one, and show it; `given` are options that mean nothing here.

    Raises CosimError for such an option, or when the table cannot be computed or written.
    """
    from fmus.planner import files  # noqa: PLC0415
    from fmus.planner.errors import PlanningError  # noqa: PLC0415  (lazy: `--help` answers at once)
    from fmus.planner.evasion import table  # noqa: PLC0415
    from fmus.planner.evasion.situation import Surroundings  # noqa: PLC0415

    if given:
        raise CosimError(f"{NAME} is a table of last points, not one plan; leave out {', '.join(given)}")
    road = Surroundings()
    try:
        files.check_outputs([] if file is None else [file])
        with _progress(shown=not as_json) as progress:
            found = table.compute(road, progress=progress)
        if file is not None:
            table.write(found, file)
    except PlanningError as error:
        raise CosimError(str(error)) from error
    if as_json:
        print(json.dumps(_data(found, road, file), indent=2))
        return
    _print(found, road, file)


def _data(found: Table, road: Surroundings, file: Path | None) -> dict[str, Any]:
    from dataclasses import asdict  # noqa: PLC0415

    from fmus.planner.evasion.table import COLUMNS  # noqa: PLC0415

    rows = [dict(zip(COLUMNS, map(float, row), strict=True)) for row in found.rows]
    return {"surroundings": asdict(road), "last_points": rows, "file": None if file is None else str(file)}


def _print(found: Table, road: Surroundings, file: Path | None) -> None:
    from cosim.command.display import console_of  # noqa: PLC0415

    console = console_of()
    console.print("last points in m: distance of the front bumper from the obstacle when braking or steering begins")
    console.print(_table(found, road))
    console.print(
        f"the car acts {road.reaction_time:g} s after the obstacle appears; it steers only if {road.reserve:g} times "
        "the last point is left",
        soft_wrap=True,
    )
    if file is not None:
        console.print(f"written to {file}", soft_wrap=True, markup=False)


def _table(found: Table, road: Surroundings) -> RichTable:
    from rich.table import Table as RichTable  # noqa: PLC0415

    table = RichTable(header_style="bold")
    columns = ("friction", "offset", "obstacle", "speed", "brake", "by the car", "steer", "brake and steer", "steering")
    for column in columns:
        table.add_column(column, justify="right")
    last = None
    for mu, offset, v, brake, by_car, steer, both in found.rows:
        if last not in (None, (mu, offset)):
            table.add_section()
        last = mu, offset
        width = max(0.0, 2 * (offset - road.clearance) - road.car_width)
        kind = "wins" if steer < brake else "with brakes" if both < brake else "loses"
        table.add_row(
            *(f"{mu:g}", f"{offset:g}", f"{width:.2f}", f"{v:g}"),
            *(f"{value:.1f}" for value in (brake, by_car, steer, both)),
            kind,
        )
    return table


@contextmanager
def _progress(*, shown: bool) -> Iterator[Callable[[int, int], None]]:
    """Tells how far the computation is, on a terminal."""
    from rich.progress import Progress  # noqa: PLC0415

    from cosim.command.display import console_of  # noqa: PLC0415

    console = console_of(stderr=True)
    if not (shown and console.is_terminal):
        yield lambda _done, _total: None
        return
    with Progress(console=console, transient=True) as bar:
        task = bar.add_task("last points", total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
