"""Options that several commands share."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from cosim.engine.schedule import Scheme
from cosim.errors import CosimError
from cosim.model.parsing import parse_assignments

Name = Annotated[str, typer.Argument(help="A scenario, see `cosim list`, or the file of a system.")]
OptionalName = Annotated[str | None, typer.Argument(metavar="NAME", help="A scenario, or the file of a system.")]
Assignments = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="instance.variable=value", help="Set a parameter, or scenario.SETTING."),
]
Events = Annotated[
    list[str] | None,
    typer.Option("--at", metavar="S:instance.input=value", help="Set an unconnected input from S seconds on."),
]
Periods = Annotated[
    list[str] | None,
    typer.Option("--period", metavar="instance=S", help="Period of an instance, or of all that fit a pattern, in s."),
]
Seed = Annotated[int, typer.Option(help="Seed of all noise; equal seeds give bit-identical runs.")]
StopTime = Annotated[float | None, typer.Option("--stop-time", metavar="S", help="End of the run, in s.")]
Parameters = Annotated[
    list[Path] | None,
    typer.Option("--params", metavar="FILE.toml", help="Values of parameters from a file; --set comes after them."),
]
Replacements = Annotated[
    list[str] | None,
    typer.Option("--replace", metavar="INSTANCE=FILE.fmu", help="Put an FMU of your own in the place of an instance."),
]
EventFiles = Annotated[
    list[str] | None,
    typer.Option("--events", metavar="FILE.toml", help="Events and faults from a file, or one of `cosim list`."),
]
Stepping = Annotated[
    Scheme, typer.Option(help="jacobi: all step together and exchange afterwards, as most other tools do.")
]
Step = Annotated[float | None, typer.Option(metavar="S", help="One communication step for all, in s.")]
Output = Annotated[Path | None, typer.Option("-o", "--output", help="Results folder; results/NAME if left out.")]
RecordEvery = Annotated[
    float | None, typer.Option(metavar="S", help="Time between two recorded rows, in s; 0 records at every tick.")
]
RecordAll = Annotated[bool, typer.Option("--record-all", help="Record the signals too that the scenario leaves out.")]
Isolate = Annotated[
    list[str] | None,
    typer.Option(metavar="INSTANCE", help="Give instances processes of their own; a pattern such as car*, or all."),
]
IsolateTimeout = Annotated[
    float, typer.Option(metavar="S", help="What a call of an isolated instance may take, in s of wall time.")
]
Realtime = Annotated[
    float | None, typer.Option(metavar="FACTOR", help="Keep to the clock: 1 is real time, 2 twice as fast.")
]
CheckpointEvery = Annotated[
    float | None, typer.Option(metavar="S", help="Keep a checkpoint every so many simulated s.")
]
Resume = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Go on from the checkpoint in DIR; with --set and -o branch off.")
]
Explain = Annotated[bool, typer.Option("--explain", help="Print order, periods, edges and conversions.")]
Quiet = Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")]
AsJson = Annotated[bool, typer.Option("--json", help="Print the summary as JSON and nothing else.")]
Strict = Annotated[bool, typer.Option("--strict", help="Exit with 1 when the mission was missed.")]
NoReport = Annotated[bool, typer.Option("--no-report", help="Draw no overview.png.")]


def assigned(assignments: list[str] | None, parameters: list[Path] | None) -> list[tuple[str, str]]:
    """(signal, text) from files of parameters and from --set, which overrules them; raises CosimError."""
    if not parameters:
        return parse_assignments(assignments or [])
    from cosim.system_file.parameters import read_parameters  # noqa: PLC0415 - only for those who have such a file

    from_files = [pair for file in parameters for pair in read_parameters(file)]
    return [*from_files, *parse_assignments(assignments or [])]


def replacements(texts: list[str] | None) -> list[tuple[str, Path]]:
    """(instance, file) from ["hlc=my.fmu"]; raises CosimError."""
    pairs = [text.partition("=") for text in texts or []]
    for instance, _, file in pairs:
        if not instance or not file:
            raise CosimError(f"cannot read {instance!r}; write --replace INSTANCE=FILE.fmu")
    return [(instance.strip(), Path(file)) for instance, _, file in pairs]
