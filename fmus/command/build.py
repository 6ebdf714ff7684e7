"""`fmus build`: FMUs of the catalogue as files."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

from fmukit.compiling.compiler import PLATFORMS
from fmukit.component import Component
from fmukit.errors import UserError
from fmukit.packaging import builder
from fmus import CATALOGUE


def build(
    names: Annotated[
        list[str] | None, typer.Argument(metavar="[NAME]...", help="FMUs (default: all); platform names count too.")
    ] = None,
    directory: Annotated[Path, typer.Option("-d", "--directory", help="Where to put the FMUs.")] = Path("fmu"),
    platform: Annotated[
        list[str] | None, typer.Option(help="linux64, win64 or both: --platform linux64 win64 (default: this one).")
    ] = None,
    crosscheck: Annotated[
        bool, typer.Option("--crosscheck", help="Write inputs and reference results of a run beside each FMU.")
    ] = False,
) -> None:
    """Build FMUs into a folder and print their paths."""
    platforms = list(dict.fromkeys([*(platform or []), *(name for name in names or [] if name in PLATFORMS)]))
    for component in _selected([name for name in names or [] if name not in PLATFORMS]):
        with _busy(component.interface.name):
            path = builder.build(component, directory, platforms, bundle=crosscheck)
        print(path, flush=True)


@contextmanager
def _busy(name: str) -> Iterator[None]:
    """A spinner and the time passed, only on a terminal."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not sys.stderr.isatty()) as progress:
        progress.add_task(name, total=None)
        yield


def _selected(names: Sequence[str]) -> list[Component]:
    """The components of these names, all of them for no names; raises UserError for one that does not exist."""
    catalogue = {component.interface.name: component for component in CATALOGUE}
    unknown = [name for name in names if name not in catalogue]
    if unknown:
        raise UserError(f"there is no FMU {unknown[0]}; choose from {', '.join(sorted(catalogue))}")
    return [catalogue[name] for name in names] or list(CATALOGUE)
