"""`cosim convert`, `cosim compare` and `cosim show`: what to do with the results of runs."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Annotated

import typer
from rich.table import Table

from cosim.command.terminal import notices
from cosim.errors import CosimError, RunFailedError
from cosim.results.comparing import compare
from cosim.results.converting import convert
from cosim.results.plotting import plotted, save
from cosim.results.reading import Results, load_results
from cosim.results.selection import signals
from fmukit.console import console_of

_SHOWN = 20
Folder = Annotated[Path, typer.Argument(metavar="DIR", help="Results folder of a run.")]
Patterns = Annotated[
    list[str] | None,
    typer.Option("--signal", metavar="PATTERN", help="Signals such as plant.*; all if left out."),
]


def convert_command(
    folder: Folder,
    *,
    file: Annotated[Path, typer.Option("-o", "--output", help="FILE.csv, FILE.mat or FILE.mf4.")],
    patterns: Patterns = None,
    every: Annotated[float, typer.Option(metavar="S", help="Time between two rows, in s; 0 takes every row.")] = 0.0,
) -> None:
    """Write the results of a run as CSV, MAT or ASAM MDF 4."""
    notices(shown=True)
    print(convert(load_results(folder), file, patterns or (), every))


def compare_command(
    first: Folder,
    second: Folder,
    *,
    patterns: Patterns = None,
    tolerance: Annotated[
        float | None, typer.Option(metavar="X", help="Exit with 1 if a signal differs by more than X of its range.")
    ] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Draw the signals that differ most.")] = None,
) -> None:
    """Hold the results of two runs against each other, signal by signal."""
    notices(shown=True)
    one, other = load_results(first), load_results(second)
    found = compare(one, other, patterns or ())
    differing = found.beyond(0.0)
    console = console_of()
    console.print(f"{len(found.differences) - len(differing)} of {len(found.differences)} signals are equal to the bit")
    if differing:
        table = Table("signal", "largest difference", "unit", "at", "of its range", header_style="bold")
        for each in differing[:_SHOWN]:
            numbers = f"{each.largest:.3g}", each.unit, f"{each.at:g} s", f"{each.relative:.2g}"
            table.add_row(each.signal, *numbers)
        console.print(table, markup=False)
    for count, name in ((len(found.only_first), first), (len(found.only_second), second)):
        if count:
            console.print(f"{count} more only in {name}", markup=False)
    if plot is not None and differing:
        save(plotted({str(first): one, str(second): other}, [each.signal for each in differing[:4]]), plot)
    if tolerance is not None and not found.differences:
        raise RunFailedError("the two runs have no signal in common")
    if tolerance is not None and not patterns and (found.only_first or found.only_second):
        raise RunFailedError("each of the two runs has to have the signals of the other; choose some with --signal")
    beyond = found.beyond(tolerance) if tolerance is not None else []
    if beyond:
        who = "a signal differs" if len(beyond) == 1 else f"{len(beyond)} signals differ"
        raise RunFailedError(f"{who} by more than {tolerance:g} of the range")


def show_command(
    folder: Folder,
    names: Annotated[list[str], typer.Argument(metavar="SIGNAL...", help="Names or patterns of signals.")],
    *,
    file: Annotated[Path | None, typer.Option("-o", "--output", help="A picture instead of a window.")] = None,
) -> None:
    """Plot signals of a run in a window, or into a file."""
    notices(shown=True)
    results = load_results(folder)
    figure = plotted({str(folder): results}, _plottable(results, names))
    if file is not None:
        save(figure, file)
        print(file)
        return
    if sys.platform.startswith("linux") and not (os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY")):
        raise CosimError("there is no screen for a window; write a picture with -o FILE.png")
    from matplotlib import pyplot as plt  # noqa: PLC0415 - only for a window

    plt.show()


def _plottable(results: Results, names: list[str]) -> list[str]:
    chosen = [name for name in signals(results, names) if results[name].dtype.kind in "fiub"]
    if len(chosen) > _SHOWN:
        raise CosimError(f"{len(chosen)} signals are too many for one picture; name up to {_SHOWN}")
    if not chosen:
        raise CosimError("these signals are texts; there is nothing to plot")
    return chosen
