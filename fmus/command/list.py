"""`fmus list`: the catalogue as a table or as JSON."""

from __future__ import annotations

import json
from typing import Annotated

import typer
from rich.console import Console
from rich.table import Table

from fmukit.component import Component
from fmus import CATALOGUE


def show(as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False) -> None:
    """Show the catalogue: name, kind, step and ports of every FMU."""
    if as_json:
        print(json.dumps([_facts(component) for component in CATALOGUE], indent=2))
    else:
        Console().print(_table())


def _table() -> Table:
    table = Table(box=None)
    table.add_column("name", min_width=max(len(component.interface.name) for component in CATALOGUE))
    table.add_column("kind")
    for heading in ("step [s]", "par", "in", "out"):
        table.add_column(heading, justify="right")
    table.add_column("what it is")
    for component in CATALOGUE:
        face = component.interface
        counts = [str(len(face.select(causality))) for causality in ("parameter", "input", "output")]
        table.add_row(face.name, face.kind, f"{face.step:g}", *counts, face.description + _needs(component))
    return table


def _needs(component: Component) -> str:
    return f" (its host needs Python with {' and '.join(component.packages)})" if component.packages else ""


def _facts(component: Component) -> dict[str, object]:
    face = component.interface
    ports = [
        {"name": v.name, "causality": v.causality, "type": v.type, "unit": v.unit, "description": v.description}
        for v in face.variables
    ]
    about = {"name": face.name, "kind": face.kind, "step": face.step, "description": face.description}
    return about | {"packages": list(component.packages), "ports": ports}
