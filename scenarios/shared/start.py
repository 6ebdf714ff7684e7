"""Where a car starts: on the first point of its reference, or beside it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from fmukit.runtime.description import TableFile
from fmukit.runtime.table import TableError, read
from fmus.controllers.reference.interface import INTERFACE as REFERENCE


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
    offset = offset or Offset()
    x, y, course, speed = first_point(configuration, car)
    x, y = x - offset.lateral * math.sin(course), y + offset.lateral * math.cos(course)
    start_at(configuration, Point(x, y, course + offset.yaw, speed + offset.speed), car)


def first_point(configuration: Configuration, car: str = "") -> Point:
    """Where the reference of the car begins; raises CosimError for a trajectory that cannot be read."""
    reference = f"{car}reference"
    file = str(configuration.value(reference, "trajectory_file"))
    if file:
        return _first_row(file)
    names = ("initial.x", "initial.y", "initial.course", "initial_speed")
    return Point(*(configuration.number(reference, name) for name in names))


def start_at(configuration: Configuration, point: Point, car: str = "") -> None:
    """Start the car, and the filter's belief if there is one, at `point` unless told otherwise."""
    start = {"position.x": point.x, "position.y": point.y, "yaw": _wrapped(point.course), "speed": point.speed}
    for instance in (f"{car}plant", f"{car}filter"):
        if instance in configuration:
            for variable, value in start.items():
                configuration.default(instance, f"initial.{variable}", value)


def _first_row(file: str) -> Point:
    """The first row of a trajectory, read as ReferenceTrajectory reads it."""
    table = REFERENCE.table
    assert table is not None
    try:
        row, _ = read(file, TableFile(0, table.columns, table.rows, table.increasing), Path())
    except TableError as error:
        raise CosimError(str(error)) from None
    first = dict(zip(table.columns, row, strict=False))
    return Point(*(first[name] for name in Point._fields))


def _wrapped(angle: float) -> float:
    """Into [-pi, pi]."""
    return math.remainder(angle, math.tau)
