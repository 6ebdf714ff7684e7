"""Where the cars of a formation start: each in its place behind the head, or beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from scenarios.formation.distances import smallest_distance, usual_outline
from scenarios.formation.timetable import Formation
from scenarios.formation.topology import HEAD, Place, prefix
from scenarios.shared.start import Point, first_point, start_at

_BESIDE: tuple[Place, ...] = ((-1.0, 0.5), (0.6, -1.0), (-0.4, -0.8), (0.8, 0.7))
"""Directions in which followers are displaced, by turns (free choice)."""


def start_in_formation(configuration: Configuration, formation: Formation) -> None:
    """The head starts on its reference, every follower in its place, displaced by about the initial error.

    All start on the course and with the speed of the head. What the user set of a car stays. Raises CosimError when the
    displaced cars would overlap, or would have to drive through one another.
    """
    head, error = first_point(configuration, prefix(HEAD)), formation.initial_error
    start_at(configuration, head, prefix(HEAD))
    c, s = math.cos(head.course), math.sin(head.course)
    wanted = starts(configuration, formation.leaders, head.speed)
    if error > 0.0:
        _keep_apart(wanted, error)
    for k, (along, across) in displaced(wanted, error).items():
        x, y = head.x + c * along - s * across, head.y + s * along + c * across
        start_at(configuration, Point(x, y, head.course, head.speed), prefix(k))


def displaced(places: Mapping[int, Place], error: float) -> dict[int, Place]:
    """Places [m] of the followers, each beside the wanted one by about `error` [m]."""
    return {k: (x + error * _BESIDE[k % 4][0], y + error * _BESIDE[k % 4][1]) for k, (x, y) in places.items()}


def starts(configuration: Configuration, leaders: Mapping[int, int], speed: float) -> dict[int, Place]:
    """The wanted places [m] of the followers behind the head while all are aligned and drive at `speed` [m/s]."""
    found: dict[int, Place] = {HEAD: (0.0, 0.0)}
    for k, leader in leaders.items():
        names = ("formation.x", "formation.y", "headway")
        x, y, headway = (configuration.number(f"{prefix(k)}follower", name) for name in names)
        found[k] = found[leader][0] + x - headway * speed, found[leader][1] + y
    return {k: place for k, place in found.items() if k != HEAD}


def _keep_apart(wanted: Mapping[int, Place], error: float) -> None:
    """Neither where they start nor, all drawing nearer alike, on the straight way from there to their places."""
    ways = [[(0.0, 0.0), *displaced(wanted, share * error).values()] for share in np.linspace(0.0, 1.0, 41)]
    poses = np.pad(np.array(ways), ((0, 0), (0, 0), (0, 1)))
    if smallest_distance(poses, usual_outline()) <= 0.0:
        raise CosimError(
            f"scenario.initial_error = {error:g} m puts cars into one another, at the start or on the way to their "
            "places; give less, or more scenario.spacing and scenario.lateral_spacing"
        )
