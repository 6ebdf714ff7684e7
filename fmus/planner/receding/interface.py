"""What RecedingHorizonPlanner shows."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fmukit.interface import CsvTable, Variable, group, input_, load_parameters, output, sampled
from fmus.cars import published
from fmus.controllers.bus import trajectory_bus
from fmus.planner.road_columns import COLUMNS, PUBLISHED

ROWS = 4000
_HERE = Path(__file__).parent
_UNUSED = ("wheel.radius",)


def _design() -> list[Variable]:
    """The numbers of the single-track car as `design.*`."""
    return [
        replace(variable, name=f"design.{variable.name}", description=f"assumed {variable.description}")
        for variable in published.single_track_parameters()
        if variable.name not in _UNUSED
    ]


_INPUTS = [
    *group(input_, "estimate.position", "xy", "m", "world position of O1 (replan.from_estimate)"),
    input_("estimate.yaw", "rad", "yaw angle (replan.from_estimate)"),
    *group(input_, "estimate.velocity", "xy", "m/s", "velocity of O1 in body axes (replan.from_estimate)"),
    input_("estimate.yaw_rate", "rad/s", "yaw rate (replan.from_estimate)"),
]

_OUTPUTS = [
    output("solver.status", "1", "last search: 1 solved, 2 solved less exactly, below 0 not solved, 0 none yet"),
    output("solver.iterations", "1", "iterations of the last search"),
    output("solver.time", "s", "duration of the last search; 0 unless solver.timed"),
    output("solver.violation", "1", "largest violation of a constraint by the last search, scaled"),
    output("solver.slack", "1", "largest slack of the last search [m or m/s], 0 unless it was softened"),
    output("problem.count", "1", "searches so far"),
    output("problem.failed", "1", "local problems without a solution so far"),
    output("fallback.count", "1", "fallbacks so far"),
    output("fallback.kind", "1", "last fallback: 1 rest of the last problem, 2 softened problem, 3 braking, 0 none"),
    output("replan.count", "1", "plans begun anew at the estimate so far"),
    output("plan.phase", "1", "0 planning, 1 the end of the road is planned, 2 given up: braking to a stop"),
    output("plan.end_time", "s", "time up to which is planned"),
    output("plan.distance", "m", "distance along the road up to which is planned"),
    output("plan.final_time", "s", "time of passing the end of the road, on a closed one its start; 0 until planned"),
]

INTERFACE = sampled(
    "RecedingHorizonPlanner",
    "Plans time-optimal motion along any road while driving: local problems on a receding horizon, joined",
    step=0.020,
    variables=[
        *load_parameters(_HERE / "parameters.toml"),
        *_design(),
        *_INPUTS,
        *trajectory_bus(output),
        *_OUTPUTS,
    ],
    table=CsvTable("road_file", COLUMNS, ROWS, increasing=False, names=PUBLISHED),
)
