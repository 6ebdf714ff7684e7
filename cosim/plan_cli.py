"""`cosim plan`: the time-optimal motion along a road as a trajectory file."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from cosim.errors import CosimError

if TYPE_CHECKING:
    from fmus.planner.hocp import Plan


def plan_command(
    name: Annotated[str, typer.Argument(help="double-lane-change, test-drive, or the CSV file of a centre line.")],
    *,
    m: Annotated[int, typer.Option("-m", "--intervals", help="Intervals of the plan.")] = 80,
    grid: Annotated[
        Literal["gate", "time"], typer.Option(help="gate: nodes on gates across the road; time: equal intervals.")
    ] = "gate",
    speed: Annotated[float, typer.Option(metavar="V", help="Speed at the start [m/s].")] = 10.0,
    file: Annotated[Path | None, typer.Option("-o", "--output", help="The file; NAME-plan.csv if left out.")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print the figures as JSON and nothing else.")] = False,
) -> None:
    """Plan the time-optimal motion along a road; ReferenceTrajectory plays the file."""
    from fmus.planner import plans, trajectory  # noqa: PLC0415  (lazy: `--help` answers at once)
    from fmus.planner.errors import PlanningError  # noqa: PLC0415

    target = file if file is not None else Path(f"{Path(name).stem}-plan.csv")
    try:
        found = plans.named(name, m, grid, speed)
        trajectory.write(found, target)
    except PlanningError as error:
        raise CosimError(str(error)) from error
    figures = _figures(found, target)
    if as_json:
        print(json.dumps(figures, indent=2))
        return
    for key, value in figures.items():
        print(f"{key:<20} {value:.6g}" if isinstance(value, float) else f"{key:<20} {value}")


def _figures(plan: Plan, target: Path) -> dict[str, Any]:
    """Times in s, distances in m, speed in m/s."""
    return {
        "final_time": plan.final_time,
        "final_speed": float(plan.nodes.x[2, -1]),
        "violation": plan.violation,
        "replay_error": plan.replay_error(restart=True),
        "status": plan.status,
        "iterations": plan.iterations,
        "solve_time": plan.solve_time,
        "derivatives": plan.how,
        "file": str(target),
    }
