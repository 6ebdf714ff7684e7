"""The `cosim` command."""

from __future__ import annotations

import json
import sys
from dataclasses import asdict
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, NoReturn

import typer

from cosim.engine.schedule import Scheme
from cosim.errors import CosimError, because
from fmukit.errors import UserError

if TYPE_CHECKING:
    from cosim.results.reading import Results
    from cosim.scenario import Scenario

app = typer.Typer(
    help="Run systems of FMI 2.0 co-simulation FMUs.",
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

_FAILED, _MISTAKE, _INTERRUPTED = 1, 2, 130
_UsageError: type[Exception] = typer.BadParameter.__mro__[1]  # of the click inside typer, without a public name


def main() -> None:
    """Entry point: whatever goes wrong is one sentence on stderr.

    Exit status 2 for a mistake of the user, 1 for a run that failed, 130 for one that was interrupted.
    """
    try:
        sys.exit(app(standalone_mode=False) or 0)
    except (CosimError, UserError) as error:
        _end(str(error), _MISTAKE)
    except _UsageError as error:
        _end(f"{_usage(error)}; `cosim --help` shows what there is", _MISTAKE)
    except typer.Abort:
        _end("interrupted", _INTERRUPTED)
    except OSError as error:  # whatever was not foreseen where it happens
        _end(f"{error.filename}: {because(error)}" if error.filename else because(error), _FAILED)


def _usage(error: Any) -> str:
    """One sentence, with the option it is about."""
    return " ".join(error.format_message().split()).rstrip(".?") or "say what to do"


def _end(sentence: str, status: int) -> NoReturn:
    print(f"cosim: {sentence}", file=sys.stderr)
    sys.exit(status)


@app.command("list")
def list_(as_json: Annotated[bool, typer.Option("--json", help="Print JSON only.")] = False) -> None:
    """Show the scenarios with what each reproduces."""
    import scenarios  # noqa: PLC0415  (lazy: `--help` answers at once)

    found = [scenarios.load(name) for name in scenarios.names()]
    if as_json:
        print(json.dumps([_listed(scenario) for scenario in found], indent=2))
        return
    from cosim.command.display import scenario_table  # noqa: PLC0415
    from fmukit.console import console_of  # noqa: PLC0415

    console_of().print(scenario_table(found))


@app.command()
def run(
    name: Annotated[str, typer.Argument(help="Name of a scenario, see `cosim list`.")],
    *,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="instance.variable=value", help="Set a parameter, or scenario.SETTING."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of all noise; equal seeds give bit-identical runs.")] = 0,
    stop_time: Annotated[float | None, typer.Option("--stop-time", metavar="S", help="End of the run [s].")] = None,
    scheme: Annotated[
        Scheme, typer.Option(help="jacobi: all step together and exchange afterwards, as most other tools do.")
    ] = "multirate",
    step: Annotated[float | None, typer.Option(metavar="S", help="One communication step for all [s].")] = None,
    folder: Annotated[
        Path | None, typer.Option("-o", "--output", help="Results folder; results/NAME if left out.")
    ] = None,
    events: Annotated[
        list[str] | None,
        typer.Option(
            "--at", metavar="S:instance.input=value", help="Set an unconnected input during the run, from S [s] on."
        ),
    ] = None,
    record_every: Annotated[
        float | None, typer.Option(metavar="S", help="Time between two recorded rows [s]; 0 records at every tick.")
    ] = None,
    record_all: Annotated[
        bool, typer.Option("--record-all", help="Record the signals too that the scenario leaves out.")
    ] = False,
    explain: Annotated[bool, typer.Option("--explain", help="Print order, periods, edges and conversions.")] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="Print the summary as JSON and nothing else.")] = False,
    no_report: Annotated[bool, typer.Option("--no-report", help="Draw no overview.png.")] = False,
) -> None:
    """Run a scenario and write its results."""
    import scenarios  # noqa: PLC0415
    from cosim.command import display  # noqa: PLC0415
    from cosim.model.system import parse_assignments, parse_events  # noqa: PLC0415
    from cosim.results.summary import to_json  # noqa: PLC0415
    from cosim.run import OVERVIEW, Request  # noqa: PLC0415
    from cosim.run import run as run_scenario  # noqa: PLC0415

    display.notices(shown=not quiet)
    scenario = scenarios.load(name)
    target = folder if folder is not None else Path("results") / name
    values, changes = parse_assignments(assignments or []), parse_events(events or [])
    request = Request(scenario, target, values, seed, stop_time, scheme, step, changes, record_every, record_all)
    stop = stop_time if stop_time is not None else scenario.stop_time
    explainer = display.explainer(to_stderr=as_json or quiet) if explain else display.silent
    with display.progress(stop, shown=not (quiet or as_json)) as progress:
        summary, results = run_scenario(request, explainer, progress)
    if not no_report:
        _draw(scenario, results, target / OVERVIEW)
    if as_json:
        print(to_json(summary))
    elif not quiet:
        display.show(summary, target)
    _leave(summary)


@app.command()
def export(
    name: Annotated[str, typer.Argument(help="Name of a scenario, see `cosim list`.")],
    *,
    file: Annotated[Path | None, typer.Option("-o", "--output", help="The file; NAME.ssp if left out.")] = None,
    assignments: Annotated[
        list[str] | None,
        typer.Option("--set", metavar="instance.variable=value", help="Set a parameter, or scenario.SETTING."),
    ] = None,
    seed: Annotated[int, typer.Option(help="Seed of all noise.")] = 0,
    stop_time: Annotated[float | None, typer.Option("--stop-time", metavar="S", help="End of the run [s].")] = None,
    events: Annotated[
        list[str] | None,
        typer.Option("--at", metavar="S:instance.input=value", help="Set an unconnected input during the run."),
    ] = None,
) -> None:
    """Write a scenario as SSP 1.0, with its FMUs and parameter values, for other tools."""
    import scenarios  # noqa: PLC0415
    from cosim.command.display import notices  # noqa: PLC0415
    from cosim.model.system import parse_assignments, parse_events  # noqa: PLC0415
    from cosim.run import Request  # noqa: PLC0415
    from cosim.ssp.export import export as export_ssp  # noqa: PLC0415

    notices(shown=True)
    target = file if file is not None else Path(f"{name}.ssp")
    scenario = scenarios.load(name)
    values, changes = parse_assignments(assignments or []), parse_events(events or [])
    request = Request(scenario, target.parent, values, seed, stop_time, events=changes)
    print(export_ssp(request, target))


for _entry in entry_points(group="cosim.commands"):
    app.command(_entry.name)(_entry.load())


def _draw(scenario: Scenario, results: Results, file: Path) -> None:
    if scenario.draw is None or len(results.time) < 2:
        return
    try:
        scenario.draw(results, file, scenario.title)
    except OSError as error:
        file.unlink(missing_ok=True)
        _end(f"{file} cannot be written: {because(error)}; results and summary are complete", _FAILED)


def _leave(summary: dict[str, Any]) -> None:
    if summary["status"] == "ok":
        return
    status = _INTERRUPTED if summary["status"] == "interrupted" else _FAILED
    _end(f"{summary['reason']}; the results so far are kept", status)


def _listed(scenario: Scenario) -> dict[str, Any]:
    return {
        "name": scenario.name,
        "title": scenario.title,
        "figures": scenario.figures,
        "stop_time": scenario.stop_time,
        "settings": {name: asdict(setting) for name, setting in scenario.settings.items()},
    }
