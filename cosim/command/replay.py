"""`cosim replay`: feed an FMU or a system from a log of real sensors."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

import typer
from rich.table import Table

from cosim.command.options import Assignments, Seed
from cosim.command.terminal import notices
from cosim.errors import RunFailedError
from cosim.model.parsing import parse_assignments
from cosim.replay.errors import Error
from cosim.replay.running import Replayed, replay
from cosim.results.plotting import save
from fmukit.console import console_of

PICTURE = "replay.png"


def replay_command(
    log: Annotated[Path, typer.Argument(metavar="LOG", help="The log: FILE.csv or FILE.mf4.")],
    *,
    map_file: Annotated[Path, typer.Option("--map", metavar="FILE.toml", help="Which column feeds which input.")],
    folder: Annotated[Path | None, typer.Option("-o", "--output", help="Results; results/LOG if left out.")] = None,
    assignments: Assignments = None,
    seed: Seed = 0,
) -> None:
    """Feed an FMU or a system from a log of real sensors, and hold its outputs against the log."""
    notices(shown=True)
    target = folder if folder is not None else Path("results") / log.stem
    values = parse_assignments(assignments or [])
    replayed = replay(log, map_file, target, assignments=values, seed=seed)
    if replayed.errors:
        console_of().print(_table(replayed.errors), markup=False)
        save(_picture(replayed), target / PICTURE)
    summary = replayed.finished.summary
    if summary.status != "ok":
        raise RunFailedError(f"{summary.reason}; the results so far are kept")
    print(target)


def _table(errors: Sequence[Error]) -> Table:
    headings = ("signal", "rms", "largest", "unit", "rms of range", "largest of range", "lag", "rms at lag")
    table = Table(*headings, header_style="bold")
    for each in errors:
        parts = (f"{100 * value / each.reach:.2f} %" for value in (each.rms, each.largest))
        numbers = (f"{each.rms:.4g}", f"{each.largest:.4g}", each.unit, *parts)
        table.add_row(each.signal, *numbers, f"{each.lag * 1e3:.1f} ms", f"{each.rms_at_lag:.4g}")
    return table


def _picture(replayed: Replayed) -> Any:
    """What came out over what was logged."""
    from matplotlib import pyplot as plt  # noqa: PLC0415 - takes a quarter of a second, which only a picture is worth

    results, logged = replayed.finished.results, replayed.logged
    figure, axes = plt.subplots(len(logged), 1, sharex=True, squeeze=False, figsize=(9, 1 + 2.4 * len(logged)))
    for axis, (signal, column) in zip(axes[:, 0], logged.items(), strict=True):
        axis.plot(column.times, column.values, color="0.6", linewidth=2.0, label="log")
        axis.plot(results.time, results[signal], linewidth=1.0, label=signal)
        axis.set_ylabel(f"[{results.unit(signal)}]")
        axis.legend(fontsize="small")
        axis.grid(alpha=0.3)
    axes[-1, 0].set_xlabel("time [s]")
    figure.tight_layout()
    return figure
