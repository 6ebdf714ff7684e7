"""What is the matter when a search finds no plan: with which ends there is one, found by searching again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace

import numpy as np

from fmus.planner.errors import PlanningError, SearchError
from fmus.planner.gates import Array, Gates
from fmus.planner.program import Ends
from fmus.planner.vehicle import Vehicle

NAMES = ("x", "lateral position", "speed", "sideslip", "heading", "yaw rate", "steering angle")
"""The states in messages; position and heading are those in the frame of the first or the last gate."""
_UNITS = ("m", "m", "m/s", "rad", "rad", "rad/s", "rad")
_SPEED = 2
_PLACE = (1, 4, _SPEED)
"""What a user may choose at the start: lateral position, heading, speed; a start out of a skid is no remedy."""
_SAME = 1e-2

FINE = 40
"""Intervals to try at least when there is no plan on less (engineering choice)."""

Remedy = Callable[[Ends, Gates], Ends]
"""(prescribed ends, gates) -> the ends of a plan with these. Raises SearchError when none is found."""


def check_ends(vehicle: Vehicle, gates: Gates, ends: Ends) -> None:
    """Raise PlanningError if a prescribed part of an end is outside the limits of car and road."""
    for end, k, text in ((ends.first, 0, "start"), (ends.last, -1, "end")):
        low, high = vehicle.lower.copy(), vehicle.upper.copy()
        low[1], high[1] = gates.low[k], gates.high[k]
        for name, value, least, most in zip(NAMES, end, low, high, strict=True):
            if np.isinf(value) or not (np.isnan(value) or least <= value <= most):
                raise PlanningError(f"the {name} at the {text} is {value:g}; it must be in [{least:g}, {most:g}]")


def explained(failure: SearchError, ends: Ends, gates: Gates, search: Remedy, finer: Gates) -> PlanningError:
    """The failure with what would do instead: a finer mesh, the least part of the ends that must give way.

    Else where it breaks: a search that fails shows nothing of the road. `finer` gates are tried with the ends as they
    are.
    """
    with suppress(SearchError):
        search(ends, finer)
        return PlanningError(f"{failure}; there is one on {len(finer.frames) - 1} intervals, take more of them")
    instead = ends_instead(failure, ends, lambda other: search(other, gates))
    if isinstance(instead, PlanningError):
        return instead
    x, y = gates.frames[instead, :2]
    return PlanningError(
        f"{failure}, and with free ends it breaks near x = {x:.1f} m, y = {y:.1f} m; "
        "the car may be unable to drive there, or the mesh be unlucky: take other intervals, or give it more room there"
    )


def ends_instead(failure: SearchError, ends: Ends, search: Callable[[Ends], Ends]) -> PlanningError | int:
    """The failure with the least part of the ends that must give way; the interval of the break if no ends would do."""
    try:
        free = search(Ends(_freed(ends.first, *_PLACE), _freed(ends.last)))
    except SearchError as again:
        return again.interval
    for relaxed in _relaxed(ends):
        try:
            return _instead(failure, ends, search(relaxed))
        except SearchError:
            continue
    return _instead(failure, ends, free)


def _relaxed(ends: Ends) -> Iterator[Ends]:
    """The ends with a free speed at the start, with a free last state, with a free place and heading at the start."""
    yield replace(ends, first=_freed(ends.first, _SPEED))
    yield replace(ends, last=_freed(ends.last))
    yield replace(ends, first=_freed(ends.first, *_PLACE[:-1]))


def _freed(end: Array, *which: int) -> Array:
    """The end with the states `which` free, all but the place along the road if none are named."""
    result = end.copy()
    result[list(which) or slice(1, None)] = np.nan
    return result


def _instead(failure: SearchError, asked: Ends, found: Ends) -> PlanningError:
    parts = [("starts", _changes(asked.first, found.first)), ("ends", _changes(asked.last, found.last))]
    changes = [f"{verb} with {', '.join(those)}" for verb, those in parts if those]
    if not changes:
        return PlanningError(f"{failure}, but one exists; use another mesh")
    return PlanningError(f"{failure}; there is one that {' and '.join(changes)}")


def _changes(asked: Array, found: Array) -> list[str]:
    return [
        f"a {name} of {round(value, 2) + 0.0:g} instead of {wanted:g} {unit}"
        for name, unit, wanted, value in zip(NAMES, _UNITS, asked, found, strict=True)
        if abs(value - wanted) > _SAME
    ]
