"""overview.png of a formation: where the cars drove, how well they kept their places, and what they were told to do."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import Any, Protocol

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.birds_eye import color, draw_from_above, label
from scenarios.formation.errors import FollowerErrors, errors_of_followers
from scenarios.formation.topology import HEAD
from scenarios.shared.page import Panel, draw_page, thinned

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


class Following(Protocol):
    """What the picture has to know of what was prepared: whom each follower follows, by number of the follower."""

    @property
    def leaders(self) -> Mapping[int, int]: ...


def draw(results: Results, prepared: Following, file: Path, title: str) -> None:
    """Draw all panels and save them to `file`."""
    leaders = prepared.leaders
    cars = (HEAD, *leaders)
    panels = [
        _curves("speed", "m/s", cars, _column("plant.velocity.x")),
        _curves("yaw rate", "rad/s", cars, _column("plant.angular_rate.z")),
    ]
    if leaders:
        errors = errors_of_followers(results, leaders)
        panels = [*_kept(errors), *panels, *_places(errors), *_commands(leaders), *_of_law(results, leaders)]
    draw_page(results, file, title, lambda r, axes: draw_from_above(r, axes, cars), panels, path_rows=2)


def _kept(errors: Mapping[int, FollowerErrors]) -> list[Panel]:
    """How far the hand points, and the cars themselves, are from their places."""
    return [
        _curves("error of the hand point", "m", errors, lambda _, k: _distance(errors[k], errors[k].hand)),
        _curves("error of O1", "m", errors, lambda _, k: _distance(errors[k], errors[k].position)),
    ]


def _distance(e: FollowerErrors, z: Vector) -> tuple[Vector, Vector]:
    return e.time, np.linalg.norm(z, axis=1)


def _places(errors: Mapping[int, FollowerErrors]) -> list[Panel]:
    """Where each follower is in the axes of its place, and where it is wanted."""

    def seen(axis: int) -> Curve:
        return lambda _, k: (errors[k].time, errors[k].seen[:, axis])

    return [
        _curves(f"O1 {text}; dotted: wanted", "m", errors, seen(i), _column(f"follower.offset.{name}"))
        for i, (name, text) in enumerate(_AXES)
    ]


def _commands(followers: Iterable[int]) -> list[Panel]:
    return [
        _curves("commanded acceleration", "m/s2", followers, _column("follower.command.acceleration")),
        _curves(
            "commanded yaw rate; dotted: 1 while limited",
            "rad/s",
            followers,
            _column("follower.command.yaw_rate"),
            _column("follower.saturation.yaw_rate"),
        ),
    ]


def _of_law(results: Results, followers: Iterable[int]) -> list[Panel]:
    """What only the followers' law has."""
    return [
        _curves(title, unit, followers, *(_column(f"follower.{name}") for name in names))
        for title, unit, names in _INSIDE
        if f"car{min(followers)}.follower.{names[0]}" in results
    ]


def _curves(title: str, unit: str, cars: Iterable[int], curve: Curve, dotted: Curve | None = None) -> Panel:
    """A panel with a curve of every car."""

    def panel(results: Results, axes: Any) -> None:
        for car in cars:
            for drawn, style in ((curve, {"label": label(car)}), (dotted, {"linestyle": ":"})):
                if drawn is not None:
                    time, values = drawn(results, car)
                    some = thinned(np.arange(len(time)))
                    axes.plot(time[some], values[some], color=color(car), **style)
        axes.set(title=title, ylabel=unit)

    return panel


def _column(name: str) -> Curve:
    return lambda results, car: (results.time, results[f"car{car}.{name}"])
