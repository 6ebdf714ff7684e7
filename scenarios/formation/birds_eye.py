"""The cars of a formation seen from above: where they drove, and how they stood to each other at a few instants."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.errors import pose
from scenarios.shared.page import thinned
from scenarios.shared.panels import footprints

_DRAWN = 8  # instants at which the cars are drawn
_GAP = 10.0  # m, between two instants side by side
_NAMED = 8  # cars beyond it have no name in the legends


def color(car: int) -> str:
    """That of everything that is drawn of the car."""
    return "black" if car == 1 else f"C{(car - 2) % 10}"


def label(car: int) -> str:
    """Its name in the legend; matplotlib leaves out what begins with an underscore."""
    return f"car {car}" if car <= _NAMED else "_"


def draw_from_above(results: Results, axes: Any, cars: Sequence[int]) -> None:
    """The ways of all cars, and the cars at a few instants; beneath, the cars at the same instants from near."""
    rows = np.arange(len(results.time))
    some = np.unique(np.linspace(0, len(rows) - 1, _DRAWN).astype(int))
    poses = np.stack([pose(results, car, rows) for car in cars])
    for car, (x, y, _) in zip(cars, np.moveaxis(poses, 2, 1), strict=True):
        axes.plot(x[thinned(rows)], y[thinned(rows)], color=color(car), linewidth=0.8, label=label(car))
    _cars(axes, poses[:, some], cars)
    axes.set(xlabel="x [m]", ylabel="y [m]", title="paths of O1; beneath, the formation at the instants drawn")
    axes.set_aspect("equal", adjustable="datalim")
    axes.grid(alpha=0.3)
    axes.legend(loc="upper left", ncols=4)
    _side_by_side(axes.inset_axes((0.0, 0.0, 1.0, 0.3)), poses[:, some], cars, results.time[some])


def _side_by_side(axes: Any, poses: Vector, cars: Sequence[int], times: Vector) -> None:
    """The formation as seen from the head, (cars, instants, 3), one instant beside the next."""
    c, s = np.cos(poses[0, :, 2]), np.sin(poses[0, :, 2])
    x, y, yaw = np.moveaxis(poses - poses[0], -1, 0)
    seen = np.stack((c * x + s * y, c * y - s * x, yaw), -1)
    step = float(np.ptp(seen[..., 0])) + _GAP
    seen[..., 0] += step * np.arange(len(times))
    _cars(axes, seen, cars)
    for i, time in enumerate(times):
        axes.text(step * i, seen[..., 1].max() + 0.2 * _GAP, f"{time:.3g} s", ha="center", fontsize="small")
    axes.set(xticks=[], yticks=[])
    axes.margins(0.02, 0.2)
    axes.autoscale_view()
    axes.set_aspect("equal", adjustable="datalim")


def _cars(axes: Any, poses: Vector, cars: Sequence[int]) -> None:
    for car, places in zip(cars, poses, strict=True):
        boxes = list(footprints(*places.T))
        axes.add_collection(PolyCollection(boxes, facecolors=color(car), edgecolors="black", linewidths=0.4))
