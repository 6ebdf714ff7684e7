"""overview.png of a road planned while driving: road and path, states, commands and the planner's work."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cosim.results.reading import Results
from scenarios.arbitrary_path.road import LaidRoad
from scenarios.shared.page import draw_page
from scenarios.shared.panels import DEGREES, WHEEL_TORQUES, driven_path, over_time, position_errors, speeds

_POINTS = 400
_STEERING = over_time(
    "steering angle and sideslip",
    "deg",
    {"mpc.command.steer_angle": "commanded", "plant.sideslip": "sideslip"},
    DEGREES,
    held=True,
)
_PROBLEMS = over_time(
    "local problems",
    "",
    {
        "planner.solver.iterations": "iterations of the last local problem",
        "planner.problem.failed": "failed problems",
    },
    held=True,
)


def draw(results: Results, laid: LaidRoad, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (
        *(partial(speeds, source="planner"), partial(position_errors, source="planner"), _STEERING),
        *(WHEEL_TORQUES, _ahead, _PROBLEMS),
    )
    draw_page(results, file, title, partial(_path, laid=laid), panels, path_rows=2)


def _path(results: Results, axes: Any, laid: LaidRoad) -> None:
    for side in laid.path.edges(_POINTS):
        axes.plot(*side.T, color="tab:gray")
    driven_path(results, axes, "planner")
    rows = np.flatnonzero(np.diff(results.samples("planner", "problem.count"), prepend=0.0) > 0)
    axes.plot(*(results.samples("planner", f"reference.{axis}")[rows] for axis in "xy"), "x", color="C3")
    axes.set(
        xlabel="x [m]",
        ylabel="y [m]",
        title="road; crosses: the reference when a local problem was solved",
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", ncols=3)


def _ahead(results: Results, axes: Any) -> None:
    time = results.time[results.instants("planner")]
    axes.plot(time, results.samples("planner", "plan.end_time") - time, label="planned ahead")
    axes.axhline(3.0, color="tab:gray", linestyle=":", label="preview")
    axes.set(title="time planned ahead", ylabel="s")
