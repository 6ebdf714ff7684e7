"""overview.png of a tracking run: the whole story on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.shared.page import draw_page, plot, thinned
from scenarios.shared.statistics import wrap
from scenarios.shared.tracking_errors import tracking_errors

_LENGTH, _WIDTH = 4.5, 1.8  # [m] the footprint drawn
_WHEELS = ("fl", "fr", "rl", "rr")


def draw(results: Results, _prepared: None, file: Path, title: str) -> None:
    """Draw all panels whose signals were recorded and save them to `file`."""
    panels = (
        *(_tracking, _speeds, _attitude, _accelerations),
        *(_longitudinal_forces, _lateral_forces, _position_estimate, _yaw_estimate),
    )
    draw_page(results, file, title, _path, panels)


def footprints(x: Vector, y: Vector, yaw: Vector) -> np.ndarray:
    """Rectangles (n x 4 x 2) [m] of the car centred at x, y."""
    corners = 0.5 * np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * (_LENGTH, _WIDTH)
    c, s = np.cos(yaw), np.sin(yaw)
    rotation = np.stack((np.stack((c, -s), -1), np.stack((s, c), -1)), -2)
    return np.asarray(corners @ rotation.transpose(0, 2, 1) + np.stack((x, y), -1)[:, None, :])


def _path(results: Results, axes: Any) -> None:
    rows = results.instants("reference")
    axes.plot(results["reference.reference.x"][rows], results["reference.reference.y"][rows], "k--", label="reference")
    x, y, yaw = (results[f"plant.{name}"] for name in ("position.x", "position.y", "yaw"))
    axes.plot(x, y, color="tab:blue", label="car (O1)")
    some = np.flatnonzero(np.diff(np.floor(2.0 * results.time), prepend=-1.0) > 0)
    boxes = PolyCollection(list(footprints(x[some], y[some], yaw[some])), facecolors="none", edgecolors="tab:blue")
    axes.add_collection(boxes)
    span = max(float(np.ptp(y)), 10.0)
    axes.set(xlabel="x [m]", ylabel="y [m]", title="path, car drawn every 0.5 s")
    axes.set_ylim(float(np.mean((y.min(), y.max()))) - span, float(np.mean((y.min(), y.max()))) + span)
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left")


def _tracking(results: Results, axes: Any) -> None:
    e = tracking_errors(results)
    for name, values, unit in (
        ("lateral", e.lateral, "m"),
        ("longitudinal", e.longitudinal, "m"),
        ("speed", e.speed, "m/s"),
        ("course", e.course, "rad"),
    ):
        axes.plot(e.time, values, label=f"{name} [{unit}]")
    axes.set_title("tracking errors")


def _speeds(results: Results, axes: Any) -> None:
    plot(results, axes, "reference.reference.speed", "reference")
    plot(results, axes, "plant.velocity.x", "forward")
    plot(results, axes, "filter.estimate.velocity.x", "estimated")
    axes.set(title="speed", ylabel="m/s")


def _accelerations(results: Results, axes: Any) -> None:
    plot(results, axes, "plant.acceleration.x", "longitudinal")
    plot(results, axes, "plant.acceleration.y", "lateral")
    plot(results, axes, "hlc.command.acceleration", "commanded")
    axes.set(title="acceleration of O1, body axes", ylabel="m/s2")


def _attitude(results: Results, axes: Any) -> None:
    for name in ("roll", "pitch", "sideslip"):
        plot(results, axes, f"plant.{name}", name, 180.0 / np.pi)
    axes.set(title="attitude", ylabel="deg")


def _longitudinal_forces(results: Results, axes: Any) -> None:
    _wheels(results, axes, "x", "longitudinal")


def _lateral_forces(results: Results, axes: Any) -> None:
    _wheels(results, axes, "y", "lateral")


def _wheels(results: Results, axes: Any, axis: str, text: str) -> None:
    for i, wheel in enumerate(_WHEELS):
        plot(results, axes, f"plant.tyre_force_{axis}.{wheel}", wheel, 1e-3, color=f"C{i}")
        if axis == "y":
            plot(results, axes, f"plant.tyre_force_z.{wheel}", f"{wheel} load", 1e-3, color=f"C{i}", linestyle=":")
    axes.set(title=f"wheel forces, {text}", ylabel="kN")


def _position_estimate(results: Results, axes: Any) -> None:
    limits = [_estimate(results, axes, name, f"C{i}", 1.0) for i, name in enumerate(("position.x", "position.y"))]
    axes.set_ylim(-max(limits), max(limits))
    axes.set(title="error of the estimated position, 3-sigma bands", ylabel="m")


def _yaw_estimate(results: Results, axes: Any) -> None:
    limit = _estimate(results, axes, "yaw", "C0", 180.0 / np.pi)
    axes.set_ylim(-limit, limit)
    axes.set(title="error of the estimated yaw angle, 3-sigma band", ylabel="deg")


def _estimate(results: Results, axes: Any, name: str, color: str, scale: float) -> float:
    """Draw one error with its band; gives the height that shows all but the filter's first moments."""
    rows = thinned(results.instants("filter"))
    time = results.time[rows]
    error = results[f"filter.estimate.{name}"][rows] - results[f"plant.{name}"][rows]
    if name == "yaw":
        error = wrap(error)
    band = 3.0 * scale * results[f"filter.std.{name}"][rows]
    axes.fill_between(time, -band, band, color=color, alpha=0.15, linewidth=0)
    axes.plot(time, scale * error, color=color, label=name)
    return 1.5 * max(float(np.quantile(np.abs(scale * error), 0.99)), float(np.quantile(band, 0.95)), 1e-9)
