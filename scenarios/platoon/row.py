"""Where the cars of a platoon are wanted: in a row at `SPEED`, and before one of them has moved in."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from cosim.model.system import System
from cosim.scenario import Settings
from scenarios.formation.system import HEAD, Change, name
from scenarios.formation.topology import Place, offsets, topology

SPEED = 25.0
"""Of the platoon [m/s]; the headway that the gaps begin with is that of this speed."""
_LONGEST_HAND = 50.0  # m; what a follower accepts
_SAME = 1e-6  # m


def merging(settings: Settings) -> int | None:
    """The car in the middle, which comes from the lane to the left; none without a follower."""
    size = int(settings["vehicles"])
    return max(2, size // 2) if size > 1 else None


def merge(settings: Settings, car: int, times: tuple[float, float]) -> Sequence[Change]:
    """At the first of `times` [s] the followers of `car` open the gap beside it, at the second it moves in."""
    row = _row(settings)
    abreast = row | {car: (row[car][0], settings["lateral_spacing"])}
    steps = (_beside(settings, car), abreast, row)
    seen = [_seen(settings, places) for places in steps]
    return [
        Change(time, {k: after[k] for k in after if math.dist(after[k], before[k]) > _SAME})
        for time, before, after in zip(times, seen[:-1], seen[1:], strict=True)
    ]


def _beside(settings: Settings, car: int) -> dict[int, Place]:
    """The cars behind have no gap for it yet; it drives half-way between its neighbours to be."""
    row, slot = _row(settings), _slot(settings)
    closed = {k: (x + slot if k > car else x, y) for k, (x, y) in row.items()}
    return closed | {car: (row[car][0] + 0.5 * slot, settings["lateral_spacing"])}


def _row(settings: Settings) -> dict[int, Place]:
    """Places [m] of all cars behind the head at SPEED."""
    behind = settings["headway"] * SPEED if settings["topology"] == "star" else 0.0
    cars = range(1, int(settings["vehicles"]) + 1)
    return {k: ((1 - k) * _slot(settings) - behind * (k > HEAD), 0.0) for k in cars}


def _slot(settings: Settings) -> float:
    """From car to car [m]."""
    return _gap(settings) if settings["topology"] == "chain" else float(settings["spacing"])


def _gap(settings: Settings) -> float:
    """From the head to the first follower, O1 to O1 [m]."""
    return float(settings["spacing"] + settings["headway"] * SPEED)


def _seen(settings: Settings, places: Mapping[int, Place]) -> dict[int, Place]:
    """The offsets that give these places; the headway, which followers add by themselves, is taken out."""
    found = offsets(topology(settings["topology"]).leaders(int(settings["vehicles"])), places)
    return {k: (x + settings["headway"] * SPEED, y) for k, (x, y) in found.items()}


def reach(made: System, settings: Settings) -> None:
    """Hand points where the leaders are, as far as a hand can be."""
    row = _row(settings)
    for k, leader in topology(settings["topology"]).leaders(len(row)).items():
        distance = row[leader][0] - row[k][0]
        made.instances[f"{name(k)}follower"].parameters["hand.distance"] = min(distance, _LONGEST_HAND)


def start_beside(made: System, settings: Settings, car: int) -> None:
    """The row begins without `car`, which is in the next lane."""
    for k, place in _seen(settings, _beside(settings, car)).items():
        values = made.instances[f"{name(k)}follower"].parameters
        values |= {f"formation.{axis}": place[i] for i, axis in enumerate("xy")}
