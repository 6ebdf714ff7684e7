"""overview.png of a tracking run: the whole story on one page."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from cosim.results.reading import Results
from fmus.cars.wheels import WHEELS
from scenarios.shared.page import draw_page, plot, thinned
from scenarios.shared.panels import DEGREES, car_outlines, driven_path, over_time
from scenarios.shared.statistics import wrap
from scenarios.shared.tracking_errors import tracking_errors

_SPEEDS = over_time(
    "speed",
    "m/s",
    {
        "reference.reference.speed": "reference",
        "plant.velocity.x": "forward",
        "filter.estimate.velocity.x": "estimated",
    },
)
_ACCELERATIONS = over_time(
    "acceleration of O1, body axes",
    "m/s2",
    {
        "plant.acceleration.x": "longitudinal",
        "plant.acceleration.y": "lateral",
        "hlc.command.acceleration": "commanded",
    },
)
_ATTITUDE = over_time("attitude", "deg", {f"plant.{name}": name for name in ("roll", "pitch", "sideslip")}, DEGREES)


def draw(results: Results, _prepared: None, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    panels = (
        *(_tracking, _SPEEDS, _ATTITUDE, _ACCELERATIONS),
        *(_longitudinal_forces, _lateral_forces, _position_estimate, _yaw_estimate),
    )
    draw_page(results, file, title, _path, panels)


def _path(results: Results, axes: Any) -> None:
    driven_path(results, axes, label="reference")
    car_outlines(results, axes)
    y = results["plant.position.y"]
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


def _longitudinal_forces(results: Results, axes: Any) -> None:
    _wheels(results, axes, "x", "longitudinal")


def _lateral_forces(results: Results, axes: Any) -> None:
    _wheels(results, axes, "y", "lateral")


def _wheels(results: Results, axes: Any, axis: str, text: str) -> None:
    for i, wheel in enumerate(WHEELS):
        plot(results, axes, f"plant.tyre_force_{axis}.{wheel}", wheel, 1e-3, color=f"C{i}")
        if axis == "y":
            plot(results, axes, f"plant.tyre_force_z.{wheel}", f"{wheel} load", 1e-3, color=f"C{i}", linestyle=":")
    axes.set(title=f"wheel forces, {text}", ylabel="kN")


def _position_estimate(results: Results, axes: Any) -> None:
    limits = [_estimate(results, axes, name, f"C{i}", 1.0) for i, name in enumerate(("position.x", "position.y"))]
    axes.set_ylim(-max(limits), max(limits))
    axes.set(title="error of the estimated position, 3-sigma bands", ylabel="m")


def _yaw_estimate(results: Results, axes: Any) -> None:
    limit = _estimate(results, axes, "yaw", "C0", DEGREES)
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
