"""overview.png of a double lane change: the corridor, the drive, what was commanded and what the solvers did."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.lane_change.loop import corridor
from scenarios.shared.mpc_metrics import SOLVED
from scenarios.shared.page import draw_page
from scenarios.shared.tracking_errors import tracking_errors
from scenarios.tracking.picture import footprints, plot, thinned

_WHEELS = ("fl", "fr", "rl", "rr")
_DEGREES = 180.0 / np.pi


def draw_overview(results: Results, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (
        *(_lateral_error, _speeds, _steering, _attitude),
        *(_torques, _demand, _residuals, _solvers),
    )
    draw_page(results, file, title, _path, panels)


def _path(results: Results, axes: Any) -> None:
    x, y, yaw = (results[f"plant.{name}"] for name in ("position.x", "position.y", "yaw"))
    rows = results.instants("reference")
    _corridor(axes)
    axes.plot(results["reference.reference.x"][rows], results["reference.reference.y"][rows], "k--", label="plan")
    axes.plot(x, y, color="tab:blue", label="car (O1)")
    some = np.flatnonzero(np.diff(np.floor(2.0 * results.time), prepend=-1.0) > 0)
    boxes = PolyCollection(list(footprints(x[some], y[some], yaw[some])), facecolors="none", edgecolors="tab:blue")
    axes.add_collection(boxes)
    axes.set(xlabel="x [m]", ylabel="y [m], four times as wide", title="path, car drawn every 0.5 s")
    axes.set_aspect(4.0, adjustable="datalim")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", ncols=3)


def _corridor(axes: Any) -> None:
    """Its edges, and the part in which the centre of gravity may be."""
    road = corridor()
    x = np.linspace(road.start, road.end, 700)
    low, high = (np.array(row).ravel() for row in road.limits().map(len(x))(x[None, :]))
    axes.fill_between(x, low, high, color="tab:green", alpha=0.2, linewidth=0, label="where O1 may be")
    for edge in (low - road.clearance, high + road.clearance):
        axes.plot(x, edge, color="tab:gray")


def _lateral_error(results: Results, axes: Any) -> None:
    e = tracking_errors(results)
    axes.plot(e.time, e.lateral, label="lateral")
    axes.plot(e.time, e.longitudinal, label="longitudinal")
    for level in (-0.05, 0.05):
        axes.axhline(level, color="tab:gray", linestyle=":", linewidth=1)
    axes.set(title="position error in the path frame", ylabel="m")


def _speeds(results: Results, axes: Any) -> None:
    plot(results, axes, "reference.reference.speed", "plan")
    plot(results, axes, "plant.velocity.x", "forward")
    axes.set(title="speed", ylabel="m/s")


def _steering(results: Results, axes: Any) -> None:
    plot(results, axes, "mpc.command.steer_angle", "commanded", _DEGREES, drawstyle="steps-post")
    plot(results, axes, "plant.steer_angle.fl", "left wheel", _DEGREES)
    axes.set(title="steering angle", ylabel="deg")


def _attitude(results: Results, axes: Any) -> None:
    for name in ("sideslip", "roll", "pitch"):
        plot(results, axes, f"plant.{name}", name, _DEGREES)
    axes.set(title="attitude", ylabel="deg")


def _torques(results: Results, axes: Any) -> None:
    for i, wheel in enumerate(_WHEELS):
        plot(results, axes, f"mpc.wheel_torque.{wheel}", wheel, color=f"C{i}", drawstyle="steps-post")
    axes.set(title="wheel torques", ylabel="N.m")


def _demand(results: Results, axes: Any) -> None:
    plot(results, axes, "mpc.demand.force_x", "longitudinal force [kN]", 1e-3, drawstyle="steps-post")
    plot(results, axes, "mpc.demand.moment_z", "yaw moment [kN.m]", 1e-3, drawstyle="steps-post")
    axes.set(title="what is asked of the wheels together")


def _residuals(results: Results, axes: Any) -> None:
    for name, label in (("force_x", "longitudinal [N]"), ("force_y", "lateral [N]"), ("moment_z", "moment [N.m]")):
        plot(results, axes, f"mpc.residual.{name}", label, drawstyle="steps-post")
    axes.set(title="given less wanted")


def _solvers(results: Results, axes: Any) -> None:
    for name, label, color in (("solver", "prediction", "C0"), ("allocation", "distribution", "C1")):
        plot(results, axes, f"mpc.{name}.iterations", label, color=color, drawstyle="steps-post")
        _unsolved(results, axes, name, color)
    axes.set(title="iterations of the solvers; crosses: not solved")


def _unsolved(results: Results, axes: Any, name: str, color: str) -> None:
    rows = results.instants("mpc")
    bad: Vector = rows[results[f"mpc.{name}.status"][rows] != SOLVED]
    some = thinned(bad)
    axes.plot(results.time[some], results[f"mpc.{name}.iterations"][some], "x", color=color)
