"""`fmus check`: is an FMU sound? Exit status 0 only if no file violates a rule of the standard.

1 says that one does, 2 that the arguments are unusable, 3 that nothing was violated but not every rule was decided.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.markup import escape

from fmukit.conformance import junit
from fmukit.conformance.check import ALL, check, decided, holds
from fmukit.conformance.report import records, table
from fmukit.conformance.rule import GROUPS, Finding
from fmukit.errors import UserError, because

_UNDECIDED = 3
_HELP = "Only these groups: " + ", ".join(f"{letter} {name}" for letter, name in GROUPS.items()) + "."


def check_files(
    files: Annotated[list[Path], typer.Argument(metavar="FILE...", help="FMUs, ours or anybody's.")],
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False,
    groups: Annotated[str, typer.Option(help=_HELP)] = ALL,
    strict: Annotated[bool, typer.Option("--strict", help="Exit with 1 for advice too.")] = False,
    everything: Annotated[bool, typer.Option("--all", help="List also the rules that hold.")] = False,
    report: Annotated[Path | None, typer.Option("--junit", metavar="FILE", help="Write JUnit XML.")] = None,
) -> None:
    """Check FMI 2.0 co-simulation FMUs: archive, model description, life cycle, behaviour, isolation."""
    _usable(files, groups)
    if report is not None:
        _writable(report, files)
    found = []
    for k, file in enumerate(files, start=1):
        with Console(stderr=True).status(escape(f"checking {file}")):
            found.append((file, check(file, groups, files[k:])))  # each pair once, in both orders
        if not as_json:
            Console().print(table(*found[-1], everything=everything))
    if as_json:
        print(json.dumps([record for file, findings in found for record in records(file, findings)], indent=2))
    if report is not None:
        _write(report, found, strict)
    raise typer.Exit(_status([findings for _, findings in found], strict))


def _status(found: Sequence[Sequence[Finding]], strict: bool) -> int:
    if not all(holds(findings, strict=strict) for findings in found):
        return 1
    return 0 if all(map(decided, found)) else _UNDECIDED


def _write(report: Path, found: Sequence[tuple[Path, Sequence[Finding]]], strict: bool) -> None:
    try:
        junit.write(report, found, strict=strict)
    except OSError as error:
        raise UserError(f"cannot write {report}: {because(error)}; give --junit another file") from None


def _writable(report: Path, files: Sequence[Path]) -> None:
    """Before the long check: the report must not take the place of an FMU, and its folder must be there."""
    if report.resolve() in [file.resolve() for file in files]:
        raise UserError(f"--junit {report} would overwrite the FMU; give it another file")
    if report.is_dir() or not report.parent.is_dir():
        raise UserError(f"cannot write {report}: it is a folder or in none that exists; give --junit another file")


def _usable(files: Sequence[Path], groups: str) -> None:
    for file in files:
        if not file.is_file():
            what = "is a folder" if file.is_dir() else "does not exist"
            raise UserError(f"{file} {what}; name FMU files")
    if not groups or set(groups) - set(ALL):
        raise UserError(f"there is no group {groups!r}; choose letters from {ALL}")
