"""`fmus plan`: the time-optimal motion along a road as a trajectory file."""

from __future__ import annotations

import json
import sys
from collections.abc import Mapping
from enum import StrEnum
from functools import wraps
from pathlib import Path
from typing import Annotated, Any, Literal

import typer

from fmukit.errors import UserError
from fmus.cars.double_track import DoubleTrackCar
from fmus.cars.wheels import WHEELS
from fmus.planner import files, forces, plans, trajectory
from fmus.planner.errors import PlanningError
from fmus.planner.evasion import command as avoidance
from fmus.planner.hocp import Plan
from fmus.planner.planned_cars import CARS


class WheelName(StrEnum):
    """What a user may name; a list of choices has to be an enumeration."""

    fl = "fl"
    fr = "fr"
    rl = "rl"
    rr = "rr"


def plan_command(
    context: typer.Context,
    name: Annotated[
        str,
        typer.Argument(help="double-lane-change, test-drive, the CSV file of a centre line, or collision-avoidance."),
    ],
    *,
    m: Annotated[
        int | None,
        typer.Option("-m", "--intervals", help="Intervals of the plan: 80, or as many as the road of a file needs."),
    ] = None,
    closed: Annotated[
        bool, typer.Option("--closed", help="The road of the file is joined to its start: plan the flying lap.")
    ] = False,
    grid: Annotated[
        Literal["gate", "time"], typer.Option(help="gate: nodes on gates across the road; time: equal intervals.")
    ] = "gate",
    speed: Annotated[float, typer.Option(metavar="V", help="Speed at the start, in m/s.")] = 10.0,
    car: Annotated[
        Literal["doubletrack", "vehicle16dof"], typer.Option(help="The plant the plan is for, with its start values.")
    ] = "doubletrack",
    file: Annotated[Path | None, typer.Option("-o", "--output", help="The file; NAME-plan.csv if left out.")] = None,
    forces_file: Annotated[
        Path | None,
        typer.Option("--forces", metavar="FILE", help="Also write states, inputs and wheel forces to this file."),
    ] = None,
    lost_motor: Annotated[list[WheelName] | None, typer.Option(help="A motor lost in --forces; repeatable.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON and nothing else.")] = False,
) -> None:
    """Plan the time-optimal motion along a road; ReferenceTrajectory plays the file.

    collision-avoidance is the table of the last points to brake and to steer; -o writes it as CSV.
    """
    if name == avoidance.NAME:
        avoidance.avoidance_command(file, _given(context), as_json=as_json)
        return
    if lost_motor and forces_file is None:
        raise UserError("--lost-motor changes the wheel forces only; name their file with --forces")
    if closed and _on_command_line(context, "speed"):
        raise UserError("a flying lap has no start, so no --speed there; leave one of --closed and --speed out")
    target, planned = file if file is not None else Path(f"{Path(name).stem}-plan.csv"), CARS[car]()
    try:
        road = None if name in plans.ROADS else Path(name)
        files.check_outputs([target] if forces_file is None else [target, forces_file], road)
        for remark in plans.road_remarks(name, closed=closed):
            print(f"fmus: {remark}", file=sys.stderr)
        found = plans.named(name, m, grid, speed, planned.vehicle, closed=closed)
        trajectory.write(found, target)
        figures = _figures(found, target)
        if forces_file is not None:
            figures |= _written_forces(found, planned.whole, lost_motor or [], forces_file)
    except PlanningError as error:
        raise UserError(str(error)) from error
    _print(figures, as_json=as_json)


@wraps(plan_command)
def alias(*arguments: Any, **options: Any) -> None:
    """The former name of `fmus plan`: does the same, after a remark."""
    print("fmus: `cosim plan` is `fmus plan` now", file=sys.stderr)
    plan_command(*arguments, **options)


def _print(figures: Mapping[str, Any], *, as_json: bool) -> None:
    """The figures on stdout, what to know of a poor plan on stderr."""
    for remark in plans.remarks(*(figures[key] for key in ("violation", "replay_error", "residual", "status"))):
        print(f"fmus: {remark}", file=sys.stderr)
    if as_json:
        print(json.dumps(figures, indent=2))
        return
    width = max(map(len, figures))
    for key, value in figures.items():
        print(f"{key:<{width}} {value:.6g}" if isinstance(value, float) else f"{key:<{width}} {value}")


def _given(context: typer.Context) -> list[str]:
    """The options of a plan that the user gave, as written."""
    own = {"name", "file", "as_json"}
    given = [p for p in context.command.params if p.name not in own and _on_command_line(context, p.name or "")]
    return [max(parameter.opts, key=len) for parameter in given]


def _on_command_line(context: typer.Context, name: str) -> bool:
    source = context.get_parameter_source(name)
    return source is not None and source.name == "COMMANDLINE"


def _figures(plan: Plan, target: Path) -> dict[str, Any]:
    """Times in s, distances in m, speed in m/s."""
    return {
        "final_time": plan.final_time,
        "final_speed": float(plan.nodes.x[2, -1]),
        "violation": plan.violation,
        "residual": plan.residual,
        "replay_error": plan.replay_error(restart=True),
        "status": plan.status,
        "iterations": plan.iterations,
        "intervals": len(plan.nodes.T),
        "solve_time": plan.solve_time,
        "derivatives": plan.how,
        "file": str(target),
    }


def _written_forces(plan: Plan, car: DoubleTrackCar, lost: list[WheelName], target: Path) -> dict[str, Any]:
    """Write the forces; what the wheel forces miss of the planned forces [N] and the planned moment [N.m]."""
    found = forces.along(plan, car, available=[0.0 if wheel in lost else 1.0 for wheel in WHEELS])
    forces.write(found, target)
    figures: dict[str, Any] = {}
    names = ("force_x", "force_y", "moment_z")
    for name, rms, largest in zip(names, found.rms.tolist(), found.largest.tolist(), strict=True):
        figures |= {f"residual_{name}_rms": rms, f"residual_{name}_max": largest}
    return {**figures, "forces_file": str(target)}
