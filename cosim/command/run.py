"""`cosim run`: run a scenario and write its results."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Annotated, Any

import typer

from cosim.command.explain import explanation
from cosim.command.opening import opened
from cosim.command.options import (
    Assignments,
    EventFiles,
    Events,
    OptionalName,
    Parameters,
    Periods,
    Replacements,
    Seed,
    StopTime,
    assigned,
    replacements,
)
from cosim.command.show import show
from cosim.command.terminal import notices, progress
from cosim.engine.loader import ISOLATION_TIMEOUT
from cosim.engine.schedule import Scheme
from cosim.errors import CosimError, RunFailedError, RunInterruptedError
from cosim.model.parsing import parse_events, parse_periods
from cosim.results.summary import Summary
from cosim.run.prepare import RunPlan
from cosim.run.request import Request
from cosim.run.resuming import resumed
from cosim.run.running import OVERVIEW, Finished, run
from fmukit.console import console_of
from fmukit.errors import because


def run_command(
    name: OptionalName = None,
    *,
    assignments: Assignments = None,
    parameters: Parameters = None,
    replace: Replacements = None,
    event_files: EventFiles = None,
    seed: Seed = 0,
    stop_time: StopTime = None,
    scheme: Annotated[
        Scheme, typer.Option(help="jacobi: all step together and exchange afterwards, as most other tools do.")
    ] = "multirate",
    step: Annotated[float | None, typer.Option(metavar="S", help="One communication step for all, in s.")] = None,
    folder: Annotated[
        Path | None, typer.Option("-o", "--output", help="Results folder; results/NAME if left out.")
    ] = None,
    events: Events = None,
    periods: Periods = None,
    record_every: Annotated[
        float | None, typer.Option(metavar="S", help="Time between two recorded rows, in s; 0 records at every tick.")
    ] = None,
    record_all: Annotated[
        bool, typer.Option("--record-all", help="Record the signals too that the scenario leaves out.")
    ] = False,
    isolate: Annotated[
        list[str] | None,
        typer.Option(metavar="INSTANCE", help="Give instances processes of their own; a pattern such as car*, or all."),
    ] = None,
    isolate_timeout: Annotated[
        float, typer.Option(metavar="S", help="What a call of an isolated instance may take, in s of wall time.")
    ] = ISOLATION_TIMEOUT,
    realtime: Annotated[
        float | None, typer.Option(metavar="FACTOR", help="Keep to the clock: 1 is real time, 2 twice as fast.")
    ] = None,
    checkpoint: Annotated[
        float | None, typer.Option(metavar="S", help="Keep a checkpoint every so many simulated s.")
    ] = None,
    resume: Annotated[
        Path | None, typer.Option(metavar="DIR", help="Go on from the checkpoint in DIR; with --set and -o branch off.")
    ] = None,
    explain: Annotated[bool, typer.Option("--explain", help="Print order, periods, edges and conversions.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON and nothing else.")] = False,
    strict: Annotated[bool, typer.Option("--strict", help="Exit with 1 when the mission was missed.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Draw no overview.png.")] = False,
) -> None:
    """Run a scenario and write its results."""
    notices(shown=not quiet)
    values, changes = assigned(assignments, parameters), parse_events(events or [])
    if resume is not None:
        _alone(replace, parameters, event_files, step, periods, record_every, record_all, isolate, checkpoint)
        name, folder, options = _continued(name, resume, folder, values, changes, stop_time)
    else:
        options = {
            "assignments": values,
            "seed": seed,
            "stop_time": stop_time,
            "scheme": scheme,
            "step": step,
            "events": changes,
            "record_every": record_every,
            "record_all": record_all,
            "isolate": isolate or (),
            "isolate_timeout": isolate_timeout,
            "periods": parse_periods(periods or []),
            "replacements": replacements(replace),
            "event_files": event_files or (),
            "checkpoint": checkpoint,
        }
    if name is None:
        raise CosimError("name a scenario or the file of a system; `cosim list` shows the scenarios")
    with opened(name) as scenario:
        target = folder if folder is not None else Path("results") / scenario.name
        request = Request(scenario, target, realtime=realtime, origin=name, **options)
        stop = request.stop_time if request.stop_time is not None else scenario.stop_time
        explainer = _explainer(to_stderr=as_json or quiet) if explain else lambda _plan: None
        draw = (lambda _finished: None) if no_report else partial(_draw, file=target / OVERVIEW)
        with progress(stop, shown=not (quiet or as_json)) as update:
            finished = run(request, explainer, update, draw)
    if as_json:
        print(finished.summary.json())
    elif not quiet:
        show(finished.summary, target)
    _leave(finished.summary, strict=strict)


def _alone(*options: object) -> None:
    """Raises CosimError for an option that a run that goes on does not take."""
    if any(option not in (None, False) for option in options):
        raise CosimError(
            "a run goes on with its own settings: with --resume only --set, --at, --stop-time and -o can be"
        )


def _continued(
    name: str | None,
    before: Path,
    folder: Path | None,
    values: list[tuple[str, str]],
    changes: list[tuple[float, str, str]],
    stop_time: float | None,
) -> tuple[str, Path, dict[str, Any]]:
    """What was run into `before`, the folder of results, and the options of its request with what is new."""
    if name is not None:
        raise CosimError(f"--resume goes on with what was run into {before}; leave out {name}")
    new = values or changes or stop_time is not None
    target = folder if folder is not None else before
    if new and target.resolve() == before.resolve():
        raise CosimError("a run that goes on otherwise than it began needs a folder of its own; give one with -o")
    origin, options, again = resumed(before, values)
    options["events"] = [*options["events"], *changes]
    if stop_time is not None:
        options["stop_time"] = stop_time
    return origin, target, options | {"resume": again}


def _explainer(*, to_stderr: bool) -> Callable[[RunPlan], None]:
    """Prints the explanation of a plan."""

    def explain(plan: RunPlan) -> None:
        console = console_of(stderr=to_stderr)
        for title, table in explanation(plan):
            console.print(title)
            console.print(table)

    return explain


def _draw(finished: Finished, file: Path) -> None:
    try:
        finished.draw(file)
    except KeyboardInterrupt:
        file.unlink(missing_ok=True)
        raise
    except OSError as error:
        file.unlink(missing_ok=True)
        sentence = f"{file} cannot be written: {because(error)}; results and summary are complete"
        raise RunFailedError(sentence) from None


def _leave(summary: Summary, *, strict: bool) -> None:
    if summary.status != "ok" and (strict or summary.status != "missed"):
        kind = RunInterruptedError if summary.status == "interrupted" else RunFailedError
        raise kind(f"{summary.reason}; the results so far are kept")
