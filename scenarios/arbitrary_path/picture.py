"""overview.png of a road planned while driving: road and path, states, commands and the planner's work."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cosim.results.reading import Results
from scenarios.arbitrary_path import road as _arbitrary_road
from scenarios.shared.page import draw_page
from scenarios.shared.tracking_errors import tracking_errors
from scenarios.tracking.picture import plot

_WHEELS = ("fl", "fr", "rl", "rr")
_DEGREES = 180.0 / np.pi
_POINTS = 400


def draw_overview(results: Results, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (_speeds, _errors, _steering, _torques, _ahead, _iterations)
    draw_page(results, file, title, _path, panels, path_rows=2)


def _path(results: Results, axes: Any) -> None:
    p = _arbitrary_road.parameters(results.parameters["planner"])
    for side in _arbitrary_road.path_road(p, 0.0).edges(_POINTS):
        axes.plot(*side.T, color="tab:gray")
    axes.plot(results.samples("planner", "reference.x"), results.samples("planner", "reference.y"), "k--", label="plan")
    axes.plot(results["plant.position.x"], results["plant.position.y"], color="tab:blue", label="car (O1)")
    rows = _joints(results)
    axes.plot(*(results.samples("planner", f"reference.{axis}")[rows] for axis in "xy"), "x", color="C3")
    axes.set(
        xlabel="x [m]",
        ylabel="y [m]",
        title="road; crosses: the reference when a local problem was solved",
    )
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", ncols=3)


def _joints(results: Results) -> np.ndarray:
    return np.flatnonzero(np.diff(results.samples("planner", "problem.count"), prepend=0.0) > 0)


def _speeds(results: Results, axes: Any) -> None:
    plot(results, axes, "planner.reference.speed", "plan")
    plot(results, axes, "plant.velocity.x", "forward")
    axes.set(title="speed", ylabel="m/s")


def _errors(results: Results, axes: Any) -> None:
    e = tracking_errors(results, "planner")
    axes.plot(e.time, e.lateral, label="lateral")
    axes.plot(e.time, e.longitudinal, label="longitudinal")
    axes.set(title="position error in the path frame", ylabel="m")


def _steering(results: Results, axes: Any) -> None:
    plot(results, axes, "mpc.command.steer_angle", "commanded", _DEGREES, drawstyle="steps-post")
    plot(results, axes, "plant.sideslip", "sideslip", _DEGREES)
    axes.set(title="steering angle and sideslip", ylabel="deg")


def _torques(results: Results, axes: Any) -> None:
    for i, wheel in enumerate(_WHEELS):
        plot(results, axes, f"mpc.wheel_torque.{wheel}", wheel, color=f"C{i}", drawstyle="steps-post")
    axes.set(title="wheel torques", ylabel="N.m")


def _ahead(results: Results, axes: Any) -> None:
    time = results.time[results.instants("planner")]
    axes.plot(time, results.samples("planner", "plan.end_time") - time, label="planned ahead")
    axes.axhline(3.0, color="tab:gray", linestyle=":", label="preview")
    axes.set(title="time planned ahead", ylabel="s")


def _iterations(results: Results, axes: Any) -> None:
    plot(results, axes, "planner.solver.iterations", "iterations of the last local problem", drawstyle="steps-post")
    plot(results, axes, "planner.problem.failed", "failed problems", drawstyle="steps-post")
    axes.set(title="local problems")
