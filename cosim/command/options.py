"""Options that several commands share."""

from __future__ import annotations

from typing import Annotated

import typer

Name = Annotated[str, typer.Argument(help="A scenario, see `cosim list`, or the file of a system.")]
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
