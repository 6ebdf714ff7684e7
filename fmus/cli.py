"""The `fmus` command: what there is (`list`), making it (`build`), checking it (`check`), planning (`plan`)."""

from __future__ import annotations

import json
import logging
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table

from fmukit.compiling.compiler import PLATFORMS
from fmukit.component import Component
from fmukit.conformance.command import check_command
from fmukit.errors import UserError
from fmukit.hosting.command import PASS_ON, doctor_command, host_command
from fmus import CATALOGUE
from fmus.planner.command import plan_command

# Of the click inside typer, which has no public name for it.
_UsageError: type[Exception] = typer.BadParameter.__mro__[1]
app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False)


def main() -> None:
    """Run the command; an error of the user is one sentence on stderr and exit status 2."""
    try:
        sys.exit(app(standalone_mode=False) or 0)
    except UserError as error:
        _end(str(error))
    except OSError as error:
        _end(f"{error.filename}: {error.strerror}")
    except _UsageError as error:
        _end(f"{str(error) or 'Say what to do.'} `fmus --help` shows what there is.")
    except typer.Abort:
        _end("interrupted", 130)


def _end(sentence: str, status: int = 2) -> None:
    print(f"fmus: {sentence}", file=sys.stderr)
    sys.exit(status)


@app.callback()
def _about() -> None:
    """FMUs of the vehicle and formation control system."""


app.command("check")(check_command)
app.command("host", context_settings=PASS_ON)(host_command)
app.command("doctor")(doctor_command)
app.command("plan")(plan_command)


@app.command("list")
def list_(as_json: Annotated[bool, typer.Option("--json", help="Print JSON and nothing else.")] = False) -> None:
    """The catalogue: name, kind, step and ports of every FMU."""
    if as_json:
        print(json.dumps([_facts(component) for component in CATALOGUE], indent=2))
        return
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
    Console().print(table)


@app.command()
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
    for component in _select([name for name in names or [] if name not in PLATFORMS]):
        with _busy(component.interface.name):
            path = _build(component, directory, platforms, crosscheck)
        print(path, flush=True)


@contextmanager
def _busy(name: str) -> Iterator[None]:
    """A spinner and the time passed, only on a terminal."""
    columns = (SpinnerColumn(), TextColumn("{task.description}"), TimeElapsedColumn())
    console = Console(stderr=True)
    with Progress(*columns, console=console, transient=True, disable=not sys.stderr.isatty()) as progress:
        progress.add_task(name, total=None)
        yield


def _build(component: Component, directory: Path, platforms: Sequence[str], bundle: bool) -> Path:
    # Where matplotlib cannot keep its own cache it says at length that it goes on without; the pictures are the same.
    logging.getLogger("matplotlib").setLevel(logging.ERROR)
    from fmukit.packaging.builder import build as build_fmu  # noqa: PLC0415 (imports casadi)

    return build_fmu(component, directory, platforms, bundle=bundle)


def _select(names: list[str]) -> list[Component]:
    catalogue = {component.interface.name: component for component in CATALOGUE}
    unknown = [name for name in names if name not in catalogue]
    if unknown:
        raise UserError(f"there is no FMU {unknown[0]}; choose from {', '.join(sorted(catalogue))}")
    return [catalogue[name] for name in names] or list(CATALOGUE)


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
