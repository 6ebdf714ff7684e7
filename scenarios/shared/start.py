"""Where a car starts: on the first point of its reference, or beside it."""

from __future__ import annotations

import logging
import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cosim.model.configuration import Configuration
from fmus.controllers.reference.interface import COLUMNS as REFERENCE_COLUMNS
from fmus.controllers.reference.interface import INTERFACE as REFERENCE
from fmus.controllers.reference.playback import played
from scenarios.shared.tables import read_columns
from scenarios.shared.trajectory_check import check_trajectory

_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class Offset:
    """Start minus reference: to the left [m], yaw angle [rad], speed [m/s]."""

    lateral: float = 0.0
    yaw: float = 0.0
    speed: float = 0.0


class Point(NamedTuple):
    """Position x, y [m], course [rad] and speed [m/s]."""

    x: float
    y: float
    course: float
    speed: float


def start_on_reference(configuration: Configuration, offset: Offset | None = None, car: str = "") -> None:
    """Start the car, and the filter's belief if there is one, `offset` from the reference unless told otherwise."""
    start_at(configuration, beside(first_point(configuration, car), offset or Offset()), car)


def beside(point: Point, offset: Offset) -> Point:
    """The point that is `offset` from `point`."""
    x, y, course, speed = point
    x, y = x - offset.lateral * math.sin(course), y + offset.lateral * math.cos(course)
    return Point(x, y, course + offset.yaw, speed + offset.speed)


def first_point(configuration: Configuration, car: str = "") -> Point:
    """Where the reference of the car begins; raises CosimError for a trajectory that cannot be read."""
    reference = f"{car}reference"
    file = str(configuration.value(reference, "trajectory_file"))
    if file:
        return point_at_zero(file)
    names = ("initial.x", "initial.y", "initial.course", "initial_speed")
    return Point(*(configuration.number(reference, name) for name in names))


def start_at(configuration: Configuration, point: Point, car: str = "") -> None:
    """Start the car, and the filter's belief if there is one, at `point` unless told otherwise."""
    start = {"position.x": point.x, "position.y": point.y, "yaw": _wrapped(point.course), "speed": point.speed}
    for instance in (f"{car}plant", f"{car}filter"):
        if instance in configuration:
            for variable, value in start.items():
                configuration.default(instance, f"initial.{variable}", value)


def point_at_zero(file: str) -> Point:
    """Where a trajectory is at time 0, as ReferenceTrajectory plays it: before its first row straight on."""
    columns = read_columns(file, REFERENCE)
    check_trajectory(file, columns)
    begin = float(columns["time"][0])
    if begin > 0:
        _LOG.warning("trajectory %s begins at %g s only: before, its first row is extended straight on", file, begin)
    elif begin < 0:
        _LOG.warning("trajectory %s begins at %g s: what lies before time 0 is not driven", file, begin)
    if begin == 0:
        return Point(*(float(columns[name][0]) for name in Point._fields))
    table = np.column_stack([columns[name] for name in REFERENCE_COLUMNS])
    x, y, course, speed, *_ = played(table, 0.0).tolist()
    return Point(x, y, course, speed)


def _wrapped(angle: float) -> float:
    """Into [-pi, pi]."""
    return math.remainder(angle, math.tau)
