"""Where the cars of a formation start: each in its place behind the head, or beside it."""

from __future__ import annotations

import math
from collections.abc import Mapping

from cosim.errors import CosimError
from cosim.scenarios._formation import HEAD, name
from cosim.scenarios._start import first_point, start_at, start_on_reference
from cosim.scenarios._topology import Place
from cosim.system import System

_BESIDE: tuple[Place, ...] = ((-1.0, 0.5), (0.6, -1.0), (-0.4, -0.8), (0.8, 0.7))
"""Directions in which followers are displaced, by turns (free choice)."""


def start_in_formation(system: System, leaders: Mapping[int, int], error: float) -> None:
    """The head starts on its reference, every follower in its place, displaced by about `error` [m].

    All start on the course and with the speed of the head. What the user set of a car stays.
    """
    head = name(HEAD)
    start_on_reference(system, car=head)
    x, y, course, speed = first_point(system, head)
    c, s = math.cos(course), math.sin(course)
    for k, place in starts(system, leaders, speed).items():
        along, across = (wanted + error * beside for wanted, beside in zip(place, _BESIDE[k % 4], strict=True))
        start_at(system, (x + c * along - s * across, y + s * along + c * across, course, speed), name(k))


def starts(system: System, leaders: Mapping[int, int], speed: float) -> dict[int, Place]:
    """The wanted places [m] of the followers behind the head while all are aligned and drive at `speed` [m/s]."""
    found: dict[int, Place] = {HEAD: (0.0, 0.0)}
    for k, leader in leaders.items():
        x, y, headway = (_number(system, k, variable) for variable in ("formation.x", "formation.y", "headway"))
        found[k] = found[leader][0] + x - headway * speed, found[leader][1] + y
    return {k: place for k, place in found.items() if k != HEAD}


def _number(system: System, k: int, variable: str) -> float:
    value = system.instances[f"{name(k)}follower"].parameters[variable]
    try:
        return float(value)
    except ValueError:
        raise CosimError(f"{name(k)}follower.{variable} = {value!r} is not a number") from None
