"""overview.png of a formation: where the cars drove, how well they kept their places, and what they were told to do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.collections import PolyCollection

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.metrics import Errors, error, follower_errors, pose
from scenarios.shared.page import Panel, draw_page
from scenarios.tracking.picture import footprints, thinned

_DRAWN = 8  # instants at which the cars are drawn
_GAP = 10.0  # m, between two instants side by side
_NAMED = 8  # cars beyond it have no name in the legends
_AXES = (("x", "ahead of the leader"), ("y", "to the left of the leader"))
_INSIDE = (
    ("learnt speed of the wanted place", "m/s", ("velocity.x",)),
    ("size of the output weights |W|", "m/s", ("weights.norm",)),
    ("multipliers of the constraint, east; dotted: north", "m/s2", ("multiplier.offset.x", "multiplier.offset.y")),
    ("rate of the leader's speed; dotted: lateral", "m/s2", ("leader.acceleration.x", "leader.acceleration.y")),
)
"""Titles, units and outputs, the second dotted."""
Curve = Callable[[Results, int], tuple[Vector, Vector]]
"""Of a car: times and values."""


def draw_overview(results: Results, file: Path, title: str, leaders: Mapping[int, int]) -> None:
    """Draw all panels and save them to `file`; `leaders` says who follows whom."""
    cars = (1, *leaders)
    panels = [
        _curves("speed", "m/s", cars, _column("plant.velocity.x")),
        _curves("yaw rate", "rad/s", cars, _column("plant.angular_rate.z")),
    ]
    if leaders:
        errors = {k: follower_errors(results, k, leader) for k, leader in leaders.items()}
        panels = [*_kept(errors), *panels, *_places(leaders), *_told(leaders), *_of_law(results, leaders)]
    draw_page(results, file, title, lambda r, axes: _paths(r, axes, cars), panels, path_rows=2)


def _paths(results: Results, axes: Any, cars: Sequence[int]) -> None:
    """The ways of all cars, and the cars at a few instants; beneath, the cars at the same instants from near."""
    rows = np.arange(len(results.time))
    some = np.unique(np.linspace(0, len(rows) - 1, _DRAWN).astype(int))
    poses = np.stack([pose(results, car, rows) for car in cars])
    for car, (x, y, _) in zip(cars, np.moveaxis(poses, 2, 1), strict=True):
        axes.plot(x[thinned(rows)], y[thinned(rows)], color=_color(car), linewidth=0.8, label=_label(car))
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
        axes.add_collection(PolyCollection(boxes, facecolors=_color(car), edgecolors="black", linewidths=0.4))


def _kept(errors: Mapping[int, Errors]) -> list[Panel]:
    """How far the hand points, and the cars themselves, are from their places."""

    def distance(name: str) -> Curve:
        return lambda _results, k: (errors[k].time, np.linalg.norm(getattr(errors[k], name), axis=1))

    return [
        _curves("error of the hand point", "m", errors, distance("hand")),
        _curves("error of O1", "m", errors, distance("position")),
    ]


def _places(leaders: Mapping[int, int]) -> list[Panel]:
    """Where each follower is, seen from its leader, and where it is wanted."""

    def seen(axis: int) -> Curve:
        def curve(results: Results, k: int) -> tuple[Vector, Vector]:
            rows = results.instants(f"car{k}.follower")
            own, ahead = pose(results, k, rows), pose(results, leaders[k], rows)
            return results.time[rows], -error(ahead, own, np.zeros((len(rows), 2)), 0.0)[:, axis]

        return curve

    return [
        _curves(f"O1 {text}; dotted: wanted", "m", leaders, seen(i), _column(f"follower.offset.{name}"))
        for i, (name, text) in enumerate(_AXES)
    ]


def _told(leaders: Mapping[int, int]) -> list[Panel]:
    """The commands of the followers."""
    return [
        _curves("commanded acceleration", "m/s2", leaders, _column("follower.command.acceleration")),
        _curves(
            "commanded yaw rate; dotted: 1 while limited",
            "rad/s",
            leaders,
            _column("follower.command.yaw_rate"),
            _column("follower.saturation.yaw_rate"),
        ),
    ]


def _of_law(results: Results, leaders: Mapping[int, int]) -> list[Panel]:
    """What only the followers' law has."""
    return [
        _curves(title, unit, leaders, *(_column(f"follower.{name}") for name in names))
        for title, unit, names in _INSIDE
        if f"car{min(leaders)}.follower.{names[0]}" in results
    ]


def _curves(title: str, unit: str, cars: Iterable[int], curve: Curve, dotted: Curve | None = None) -> Panel:
    """A panel with a curve of every car."""

    def panel(results: Results, axes: Any) -> None:
        for car in cars:
            for drawn, style in ((curve, {"label": _label(car)}), (dotted, {"linestyle": ":"})):
                if drawn is not None:
                    time, values = drawn(results, car)
                    some = thinned(np.arange(len(time)))
                    axes.plot(time[some], values[some], color=_color(car), **style)
        axes.set(title=title, ylabel=unit)

    return panel


def _column(name: str) -> Curve:
    return lambda results, car: (results.time, results[f"car{car}.{name}"])


def _color(car: int) -> str:
    return "black" if car == 1 else f"C{(car - 2) % 10}"


def _label(car: int) -> str:
    """matplotlib leaves out of the legend what begins with an underscore."""
    return f"car {car}" if car <= _NAMED else "_"
