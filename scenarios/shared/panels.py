"""What several pictures show alike: the car along its path, signals over time, errors of position, wheel torques."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

from cosim.model.signals import Vector
from cosim.results.reading import Results
from fmus.cars.wheels import WHEELS
from scenarios.shared.page import Panel, plot
from scenarios.shared.rectangles import footprint
from scenarios.shared.tracking_errors import tracking_errors

DEGREES = 180.0 / np.pi
_LENGTH, _WIDTH = 4.5, 1.8  # [m] the footprint drawn


def footprints(x: Vector, y: Vector, yaw: Vector) -> Vector:
    """Rectangles (n, 4, 2) [m] of a car centred at x, y (n,) [m] and turned by yaw (n,) [rad]."""
    return footprint(x, y, yaw, 0.5 * _LENGTH, 0.5 * _LENGTH, _WIDTH)


def driven_path(results: Results, axes: Any, source: str = "reference", label: str = "plan") -> None:
    """The path that the instance `source` asks for, dashed, and that of O1."""
    wanted = (results.samples(source, f"reference.{axis}") for axis in "xy")
    axes.plot(*wanted, "k--", label=label)
    axes.plot(results["plant.position.x"], results["plant.position.y"], color="tab:blue", label="car (O1)")


def car_outlines(results: Results, axes: Any) -> None:
    """The car every 0.5 s."""
    outlines(results, axes, footprints(*(results[f"plant.{name}"] for name in ("position.x", "position.y", "yaw"))), 2)


def outlines(results: Results, axes: Any, rectangles: Vector, per_second: float) -> None:
    """Of the rectangles (rows, 4, 2) of a car those `per_second` times a second."""
    some = np.flatnonzero(np.diff(np.floor(per_second * results.time), prepend=-1.0) > 0)
    axes.add_collection(PolyCollection(list(rectangles[some]), facecolors="none", edgecolors="tab:blue"))


def over_time(title: str, unit: str, labels: Mapping[str, str], scale: float = 1.0, *, held: bool = False) -> Panel:
    """A panel of signals times `scale`, with their labels; `held` draws steps, as values of samples hold."""
    style = {"drawstyle": "steps-post"} if held else {}

    def panel(results: Results, axes: Any) -> None:
        for name, label in labels.items():
            plot(results, axes, name, label, scale, **style)
        axes.set(title=title, ylabel=unit)

    return panel


def speeds(results: Results, axes: Any, source: str = "reference") -> None:
    """The speed that the instance `source` asks for, and that of the car forward."""
    plot(results, axes, f"{source}.reference.speed", "plan")
    plot(results, axes, "plant.velocity.x", "forward")
    axes.set(title="speed", ylabel="m/s")


def position_errors(results: Results, axes: Any, source: str = "reference") -> None:
    """Errors of position along and across the path that the instance `source` asks for."""
    e = tracking_errors(results, source)
    axes.plot(e.time, e.lateral, label="lateral")
    axes.plot(e.time, e.longitudinal, label="longitudinal")
    axes.set(title="position error in the path frame", ylabel="m")


WHEEL_TORQUES = over_time("wheel torques", "N.m", {f"mpc.wheel_torque.{wheel}": wheel for wheel in WHEELS}, held=True)
