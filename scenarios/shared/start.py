"""Where a car starts: on the first point of its reference, or beside it."""

from __future__ import annotations

import csv
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cosim.errors import CosimError, because
from cosim.model.face import Value
from cosim.model.system import System


@dataclass(frozen=True, slots=True)
class Offset:
    """Start minus reference: to the left [m], yaw angle [rad], speed [m/s]."""

    lateral: float = 0.0
    yaw: float = 0.0
    speed: float = 0.0


NONE = Offset()
Point = tuple[float, float, float, float]
"""x, y [m], course [rad], speed [m/s]."""


def start_on_reference(system: System, offset: Offset = NONE, car: str = "") -> None:
    """Start the car, and the filter's belief if there is one, `offset` from the reference unless told otherwise."""
    x, y, course, speed = first_point(system, car)
    x, y = x - offset.lateral * math.sin(course), y + offset.lateral * math.cos(course)
    start_at(system, (x, y, course + offset.yaw, speed + offset.speed), car)


def first_point(system: System, car: str = "") -> Point:
    """Where the reference of the car begins."""
    reference = system.instances[f"{car}reference"].parameters
    file = str(reference.get("trajectory_file", ""))
    return _first_row(Path(file)) if file else _built_in(reference)


def start_at(system: System, point: Point, car: str = "") -> None:
    """Start the car, and the filter's belief if there is one, at `point` unless told otherwise."""
    x, y, yaw, speed = point
    start = {"position.x": x, "position.y": y, "yaw": _wrapped(yaw), "speed": speed}
    for name in (f"{car}plant", f"{car}filter"):
        if name in system.instances:
            for variable, value in start.items():
                system.instances[name].parameters.setdefault(f"initial.{variable}", value)


def _built_in(reference: Mapping[str, Value]) -> Point:
    names = ("initial.x", "initial.y", "initial.course", "initial_speed")
    try:
        x, y, course, speed = (float(reference.get(name, 0.0)) for name in names)
    except ValueError:
        raise CosimError(f"one of the parameters {', '.join(names)} of reference is not a number") from None
    return x, y, course, speed


def _first_row(file: Path) -> Point:
    try:
        with file.open(newline="", encoding="utf-8-sig") as source:
            row = next(csv.DictReader(source, skipinitialspace=True))
        return float(row["x"]), float(row["y"]), float(row["course"]), float(row["speed"])
    except OSError as error:
        raise CosimError(f"cannot read the trajectory {file}: {because(error)}") from None
    except StopIteration:
        raise CosimError(f"the trajectory {file} has no row beneath its header") from None
    except KeyError as missing:
        raise CosimError(f"the trajectory {file} has no column {missing.args[0]}") from None
    except (ValueError, TypeError, csv.Error) as error:
        raise CosimError(f"the first row of the trajectory {file} is not made of numbers: {error}") from None


def _wrapped(angle: float) -> float:
    """Into [-pi, pi]; what is not finite stays and is refused where it is set."""
    return math.remainder(angle, math.tau) if math.isfinite(angle) else angle
