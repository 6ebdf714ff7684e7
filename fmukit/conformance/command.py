"""`fmus check`: is an FMU sound? Exit status 0 only if every rule holds for every file."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from fmukit.conformance.check import ALL, check, holds
from fmukit.conformance.report import records, table
from fmukit.conformance.rule import GROUPS, Finding
from fmukit.errors import UserError

_HELP = "Only these groups: " + ", ".join(f"{letter} {name}" for letter, name in GROUPS.items()) + "."


def check_files(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="FMUs, ours or anybody's.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
    groups: Annotated[str, typer.Option(help=_HELP)] = ALL,
) -> None:
    """Check FMI 2.0 co-simulation FMUs: archive, model description, life cycle, behaviour, isolation."""
    _usable(files, groups)
    found = []
    for k, file in enumerate(files, start=1):
        with Console(stderr=True).status(escape(f"checking {file}")):
            found.append((file, check(file, groups, files[k:])))  # each pair once, in both orders
        if not as_json:
            Console().print(table(*found[-1]))
    if as_json:
        print(json.dumps([record for file, findings in found for record in records(file, findings)], indent=2))
    raise typer.Exit(_status(findings for _, findings in found))


def _status(found: Iterable[Sequence[Finding]]) -> int:
    return 0 if all(holds(findings) for findings in found) else 1


def _usable(files: Sequence[Path], groups: str) -> None:
    for file in files:
        if not file.is_file():
            what = "is a folder" if file.is_dir() else "does not exist"
            raise UserError(f"{file} {what}; name FMU files")
    if not groups or set(groups) - set(ALL):
        raise UserError(f"there is no group {groups!r}; choose letters from {ALL}")
