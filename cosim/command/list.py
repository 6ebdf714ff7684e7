"""`cosim list`: the scenarios that are installed."""

from __future__ import annotations

import json
import logging
from collections.abc import Sequence
from dataclasses import asdict
from typing import Annotated, Any

import typer
from rich.table import Table

from cosim.command.terminal import notices
from cosim.errors import CosimError
from cosim.scenario.definition import Scenario
from cosim.scenario.discovery import load, names
from fmukit.console import console_of


def list_command(as_json: Annotated[bool, typer.Option("--json", help="Print JSON only.")] = False) -> None:
    """Show the scenarios with what each reproduces."""
    notices(shown=True)
    found = [scenario for name in names() if (scenario := _loaded(name)) is not None]
    if as_json:
        print(json.dumps([_listed(scenario) for scenario in found], indent=2))
    else:
        console_of().print(_table(found))


def _loaded(name: str) -> Scenario | None:
    """The scenario; None, and a word about it on stderr, when its package is broken."""
    try:
        return load(name)
    except CosimError as error:
        logging.getLogger("cosim").warning("%s", error)
        return None


def _table(scenarios: Sequence[Scenario]) -> Table:
    table = Table(header_style="bold")
    table.add_column("scenario", no_wrap=True)
    for column in ("what it is", "reproduces", "settings"):
        table.add_column(column, overflow="fold")
    for scenario in scenarios:
        settings = "\n".join(f"{name}={setting.offered}" for name, setting in scenario.settings.items())
        table.add_row(scenario.name, scenario.title, scenario.figures, settings)
    return table


def _listed(scenario: Scenario) -> dict[str, Any]:
    return {
        "name": scenario.name,
        "title": scenario.title,
        "figures": scenario.figures,
        "stop_time": scenario.stop_time,
        "settings": {name: asdict(setting) for name, setting in scenario.settings.items()},
    }
