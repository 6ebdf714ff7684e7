"""overview.png of a double lane change: the corridor, the drive, what was commanded and what the solvers did."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from cosim.results.reading import Results
from fmus.planner.road import Corridor
from scenarios.lane_change.plan import LaneChange
from scenarios.shared.mpc_metrics import SOLVED
from scenarios.shared.page import draw_page, plot, thinned
from scenarios.shared.panels import (
    DEGREES,
    WHEEL_TORQUES,
    car_outlines,
    driven_path,
    over_time,
    position_errors,
    speeds,
)

_STEERING = over_time(
    "steering angle",
    "deg",
    {"mpc.command.steer_angle": "commanded", "plant.steer_angle.fl": "left wheel"},
    DEGREES,
    held=True,
)
_ATTITUDE = over_time("attitude", "deg", {f"plant.{name}": name for name in ("sideslip", "roll", "pitch")}, DEGREES)
_DEMAND = over_time(
    "what is asked of the wheels together",
    "",
    {"mpc.demand.force_x": "longitudinal force [kN]", "mpc.demand.moment_z": "yaw moment [kN.m]"},
    1e-3,
    held=True,
)
_RESIDUALS = over_time(
    "given less wanted",
    "",
    {
        "mpc.residual.force_x": "longitudinal [N]",
        "mpc.residual.force_y": "lateral [N]",
        "mpc.residual.moment_z": "moment [N.m]",
    },
    held=True,
)


def draw(results: Results, change: LaneChange, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (
        *(_lateral_error, speeds, _STEERING, _ATTITUDE),
        *(WHEEL_TORQUES, _DEMAND, _RESIDUALS, _solvers),
    )
    draw_page(results, file, title, partial(_path, corridor=change.corridor), panels)


def _path(results: Results, axes: Any, corridor: Corridor | None) -> None:
    if corridor is not None:
        _corridor(axes, corridor)
    driven_path(results, axes)
    car_outlines(results, axes)
    wide = 4.0 if corridor is not None else 1.0
    label = "y [m], four times as wide" if corridor is not None else "y [m]"
    axes.set(xlabel="x [m]", ylabel=label, title="path, car drawn every 0.5 s")
    axes.set_aspect(wide, adjustable="datalim")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", ncols=3)


def _corridor(axes: Any, corridor: Corridor) -> None:
    """Its edges, and the part in which the centre of gravity may be."""
    x = np.linspace(corridor.start, corridor.end, 700)
    low, high = (np.array(row).ravel() for row in corridor.limits().map(len(x))(x[None, :]))
    axes.fill_between(x, low, high, color="tab:green", alpha=0.2, linewidth=0, label="where O1 may be")
    for edge in (low - corridor.clearance, high + corridor.clearance):
        axes.plot(x, edge, color="tab:gray")


def _lateral_error(results: Results, axes: Any) -> None:
    position_errors(results, axes)
    for level in (-0.05, 0.05):
        axes.axhline(level, color="tab:gray", linestyle=":", linewidth=1)


def _solvers(results: Results, axes: Any) -> None:
    for name, label, color in (("solver", "prediction", "C0"), ("allocation", "distribution", "C1")):
        plot(results, axes, f"mpc.{name}.iterations", label, color=color, drawstyle="steps-post")
        _unsolved(results, axes, name, color)
    axes.set(title="iterations of the solvers; crosses: not solved")


def _unsolved(results: Results, axes: Any, name: str, color: str) -> None:
    rows = results.instants("mpc")
    some = thinned(rows[results[f"mpc.{name}.status"][rows] != SOLVED])
    axes.plot(results.time[some], results[f"mpc.{name}.iterations"][some], "x", color=color)
