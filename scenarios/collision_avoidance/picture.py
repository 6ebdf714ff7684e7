"""overview.png of an encounter: the road with the obstacle and the car, the last points, and what was driven."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.patches import Polygon

from cosim.results.reading import Results
from scenarios.collision_avoidance.evasion import Evasion
from scenarios.collision_avoidance.geometry import car, clearance, obstacle
from scenarios.shared.page import draw_page
from scenarios.shared.panels import (
    DEGREES,
    WHEEL_TORQUES,
    driven_path,
    outlines,
    over_time,
    position_errors,
    speeds,
)

_DOES = ("brakes", "steers", "brakes and steers", "cannot avoid it and brakes and steers")
_EVERY = 4.0
_ANGLES = over_time(
    "angles",
    "deg",
    {"plant.steer_angle.fl": "steering angle", "plant.yaw": "yaw", "plant.sideslip": "sideslip"},
    DEGREES,
)
_ACCELERATIONS = over_time(
    "acceleration of O1, body axes",
    "m/s2",
    {"plant.acceleration.x": "longitudinal", "plant.acceleration.y": "lateral"},
)


def draw(results: Results, planned: Evasion, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    gap = partial(_gap, planned=planned)
    panels = (gap, speeds, position_errors, _ANGLES, _ACCELERATIONS, WHEEL_TORQUES)
    draw_page(results, file, title, partial(_path, planned=planned), panels)


def _path(results: Results, axes: Any, planned: Evasion) -> None:
    _road(axes, planned)
    driven_path(results, axes)
    outlines(results, axes, car(results, planned.surroundings), _EVERY)
    axes.add_patch(Polygon(obstacle(planned), color="tab:red", alpha=0.6, label="obstacle"))
    axes.set(xlabel="x [m]", ylabel="y [m], three times as wide")
    axes.set_title(f"the car {_DOES[planned.decision.code]}; drawn every {1 / _EVERY:g} s")
    axes.set_aspect(3.0, adjustable="datalim")
    axes.legend(loc="upper left", ncols=4, fontsize="small")


def _road(axes: Any, planned: Evasion) -> None:
    """Edges and lanes, and the last points: where O1 is when the front bumper is that far from the obstacle."""
    s, met, decided = planned.surroundings, planned.encounter, planned.decision
    for y, style in ((-0.5 * s.lane, "-"), (0.5 * s.lane, "--"), (1.5 * s.lane, "-")):
        axes.axhline(y, color="tab:gray", linestyle=style)
    lines = (("brake", decided.brake, "C1"), ("steer", decided.steer, "C2"), ("both", decided.brake_and_steer, "C4"))
    for name, way, color in lines:
        if math.isfinite(way):
            axes.axvline(met.distance - way, color=color, linestyle=":", label=f"last point to {name}")
    axes.axvline(s.delay * met.speed, color="k", linestyle=":", label="manoeuvre begins")


def _gap(results: Results, axes: Any, planned: Evasion) -> None:
    axes.plot(results.time, clearance(results, planned), label="distance from the obstacle")
    axes.set(title="distance of the two rectangles", ylabel="m")
