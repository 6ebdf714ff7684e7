"""`cosim run`: run a scenario and write its results."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

from cosim.command.explain import explanation
from cosim.command.opening import opened
from cosim.command.options import (
    AsJson,
    Assignments,
    CheckpointEvery,
    EventFiles,
    Events,
    Explain,
    Isolate,
    IsolateTimeout,
    NoReport,
    OptionalName,
    Output,
    Parameters,
    Periods,
    Quiet,
    Realtime,
    RecordAll,
    RecordEvery,
    Replacements,
    Resume,
    Seed,
    Step,
    Stepping,
    StopTime,
    Strict,
    assigned,
    replacements,
)
from cosim.command.show import show
from cosim.command.terminal import notices, progress
from cosim.engine.loader import ISOLATION_TIMEOUT
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
    scheme: Stepping = "multirate",
    step: Step = None,
    folder: Output = None,
    events: Events = None,
    periods: Periods = None,
    record_every: RecordEvery = None,
    record_all: RecordAll = False,
    isolate: Isolate = None,
    isolate_timeout: IsolateTimeout = ISOLATION_TIMEOUT,
    realtime: Realtime = None,
    checkpoint: CheckpointEvery = None,
    resume: Resume = None,
    explain: Explain = False,
    quiet: Quiet = False,
    as_json: AsJson = False,
    strict: Strict = False,
    no_report: NoReport = False,
) -> None:
    """Run a scenario and write its results."""
    notices(shown=not quiet)
    values, changes = assigned(assignments, parameters), parse_events(events or [])
    if resume is not None:
        _alone(replace, parameters, event_files, step, periods, record_every, record_all, isolate, checkpoint)
        name, folder, options = _continued(name, resume, folder, values, changes, stop_time)
    else:
        options = {
            **{"assignments": values, "events": changes, "periods": parse_periods(periods or [])},
            **{"seed": seed, "stop_time": stop_time, "scheme": scheme, "step": step, "checkpoint": checkpoint},
            **{"record_every": record_every, "record_all": record_all, "event_files": event_files or ()},
            **{"isolate": isolate or (), "isolate_timeout": isolate_timeout, "replacements": replacements(replace)},
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
