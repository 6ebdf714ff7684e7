"""overview.png of an encounter: the road with the obstacle and the car, the last points, and what was driven."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.patches import Polygon

from cosim.results.reading import Results
from scenarios.collision_avoidance import loop, metrics
from scenarios.shared.page import draw_page
from scenarios.shared.tracking_errors import tracking_errors
from scenarios.tracking.picture import plot

_ACTIONS = ("brakes", "steers", "brakes and steers", "cannot avoid it and brakes and steers")
_WHEELS = ("fl", "fr", "rl", "rr")
_EVERY = 4.0


def draw_overview(results: Results, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (
        *(_gap, _speeds, _errors),
        *(_steering, _accelerations, _torques),
    )
    draw_page(results, file, title, _path, panels)


def _path(results: Results, axes: Any) -> None:
    x, y = results["plant.position.x"], results["plant.position.y"]
    _road(results, axes)
    rows = results.instants("reference")
    axes.plot(results["reference.reference.x"][rows], results["reference.reference.y"][rows], "k--", label="plan")
    axes.plot(x, y, color="tab:blue", label="car (O1)")
    some = np.flatnonzero(np.diff(np.floor(_EVERY * results.time), prepend=-1.0) > 0)
    shapes = list(metrics.car(results)[some])
    axes.add_collection(PolyCollection(shapes, facecolors="none", edgecolors="tab:blue"))
    axes.add_patch(Polygon(metrics.obstacle(results), color="tab:red", alpha=0.6, label="obstacle"))
    decided = loop.decision(results.settings)
    axes.set(xlabel="x [m]", ylabel="y [m], three times as wide")
    axes.set_title(f"the car {_ACTIONS[decided.code]}; drawn every {1 / _EVERY:g} s")
    axes.set_aspect(3.0, adjustable="datalim")
    axes.legend(loc="upper left", ncols=4, fontsize="small")


def _road(results: Results, axes: Any) -> None:
    """Edges and lanes, and the last points: where O1 is when the front bumper is that far from the obstacle."""
    from fmus.planner.evasion.situation import Surroundings  # noqa: PLC0415  (lazy: `cosim list`)

    s, met = Surroundings(), loop.encounter(results.settings)
    for y, style in ((-0.5 * s.lane, "-"), (0.5 * s.lane, "--"), (1.5 * s.lane, "-")):
        axes.axhline(y, color="tab:gray", linestyle=style)
    decided = loop.decision(results.settings)
    lines = (("brake", decided.brake, "C1"), ("steer", decided.steer, "C2"), ("both", decided.brake_and_steer, "C4"))
    for name, way, color in lines:
        if math.isfinite(way):
            axes.axvline(met.distance - way, color=color, linestyle=":", label=f"last point to {name}")
    axes.axvline(s.delay * met.speed, color="k", linestyle=":", label="manoeuvre begins")


def _gap(results: Results, axes: Any) -> None:
    axes.plot(results.time, metrics.clearance(results), label="distance from the obstacle")
    axes.set(title="distance of the two rectangles", ylabel="m")


def _speeds(results: Results, axes: Any) -> None:
    plot(results, axes, "reference.reference.speed", "plan")
    plot(results, axes, "plant.velocity.x", "forward")
    axes.set(title="speed", ylabel="m/s")


def _errors(results: Results, axes: Any) -> None:
    e = tracking_errors(results)
    axes.plot(e.time, e.lateral, label="lateral")
    axes.plot(e.time, e.longitudinal, label="longitudinal")
    axes.set(title="position error in the path frame", ylabel="m")


def _steering(results: Results, axes: Any) -> None:
    degrees = 180.0 / np.pi
    plot(results, axes, "plant.steer_angle.fl", "steering angle", degrees)
    plot(results, axes, "plant.yaw", "yaw", degrees)
    plot(results, axes, "plant.sideslip", "sideslip", degrees)
    axes.set(title="angles", ylabel="deg")


def _accelerations(results: Results, axes: Any) -> None:
    plot(results, axes, "plant.acceleration.x", "longitudinal")
    plot(results, axes, "plant.acceleration.y", "lateral")
    axes.set(title="acceleration of O1, body axes", ylabel="m/s2")


def _torques(results: Results, axes: Any) -> None:
    for i, wheel in enumerate(_WHEELS):
        plot(results, axes, f"mpc.wheel_torque.{wheel}", wheel, color=f"C{i}", drawstyle="steps-post")
    axes.set(title="wheel torques", ylabel="N.m")
