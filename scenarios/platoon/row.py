"""Where the cars of a platoon are wanted: in a row at `SPEED`, and before one of them has moved in.

Across the road, the wanted point at r in the leader's axes swings with its yaw angle, and a hand point a ahead of O1
answers with y (1 + s a/v): what the law makes of it is multiplied by (1 + s r/v)/(1 + s a/v). With r = a - gap the
swinging grows from car to car unless a >= gap/2, and least with r = 0. With a headway the gap changes with the speed;
the hand point is put where the leader is half-way between the lowest and the highest speed.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from cosim.scenario.settings import Settings
from scenarios.formation.timetable import Formation, Transition
from scenarios.formation.topology import HEAD, Place, offsets

SPEED = 25.0
"""Of the platoon [m/s]; the headway that the gaps begin with is that of this speed."""
_MIDDLE = 17.5
"""Half-way between the speeds the head brakes from and to [m/s]."""
_MOVE_IN = 14.0  # s after the gap began to open
_LONGEST_HAND = 50.0  # m; what a follower accepts
_SAME = 1e-6  # m


def with_merge(formation: Formation, settings: Settings, begin: float) -> Formation:
    """The row that begins without the car in its middle, which is in the lane to the left; as it is without a follower.

    At `begin` [s] the followers of that car open the gap beside it, and 14 s later it moves in.
    """
    if not formation.leaders:
        return formation
    car, row = max(2, int(settings["vehicles"]) // 2), _row(settings)
    abreast = row | {car: (row[car][0], settings["lateral_spacing"])}
    seen = [_seen(settings, formation.leaders, places) for places in (_beside(settings, car), abreast, row)]
    timetable = [
        Transition(time, _moved(before, after))
        for time, before, after in zip((begin, begin + _MOVE_IN), seen[:-1], seen[1:], strict=True)
    ]
    return replace(formation, offsets=seen[0], timetable=timetable)


def hand_distances(formation: Formation, settings: Settings) -> dict[int, float]:
    """`hand.distance` [m] by number of the follower: the hand points are where the leaders are, as far as they can."""
    row, nearer = _row(settings), settings["headway"] * (SPEED - _MIDDLE)
    return {k: min(row[leader][0] - row[k][0] - nearer, _LONGEST_HAND) for k, leader in formation.leaders.items()}


def _moved(before: Mapping[int, Place], after: Mapping[int, Place]) -> dict[int, Place]:
    """The places of those cars that have others than before."""
    return {k: after[k] for k in after if math.dist(after[k], before[k]) > _SAME}


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
    """From car to car, O1 to O1 [m]; in a chain everybody adds the headway."""
    headway = settings["headway"] * SPEED if settings["topology"] == "chain" else 0.0
    return float(settings["spacing"] + headway)


def _seen(settings: Settings, leaders: Mapping[int, int], places: Mapping[int, Place]) -> dict[int, Place]:
    """The offsets that give these places; the headway, which followers add by themselves, is taken out."""
    return {k: (x + settings["headway"] * SPEED, y) for k, (x, y) in offsets(leaders, places).items()}
