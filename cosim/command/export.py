"""`cosim export`: write a scenario as SSP 1.0, or as a system file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.command.opening import opened
from cosim.command.options import (
    Assignments,
    EventFiles,
    Events,
    Name,
    Parameters,
    Periods,
    Replacements,
    Seed,
    StopTime,
    assigned,
    replacements,
)
from cosim.command.terminal import notices
from cosim.model.parsing import parse_events, parse_periods
from cosim.run.request import Request
from cosim.ssp.export import export


def export_command(
    name: Name,
    *,
    file: Annotated[
        Path | None, typer.Option("-o", "--output", help="FILE.ssp or FILE.toml; NAME.ssp if left out.")
    ] = None,
    assignments: Assignments = None,
    parameters: Parameters = None,
    replace: Replacements = None,
    event_files: EventFiles = None,
    seed: Seed = 0,
    stop_time: StopTime = None,
    events: Events = None,
    periods: Periods = None,
) -> None:
    """Write a scenario as SSP 1.0, with its FMUs and values, for other tools; or as a TOML file, to change it."""
    notices(shown=True)
    values, changes = assigned(assignments, parameters), parse_events(events or [])
    with opened(name) as scenario:
        target = file if file is not None else Path(f"{scenario.name}.ssp")
        request = Request(
            scenario,
            target.parent,
            values,
            seed,
            stop_time,
            events=changes,
            periods=parse_periods(periods or []),
            replacements=replacements(replace),
            event_files=event_files or (),
        )
        if target.suffix == ".toml":
            from cosim.system_file.writing import export_system  # noqa: PLC0415 - only for those who want one

            print(export_system(request, target))
        else:
            print(export(request, target))
