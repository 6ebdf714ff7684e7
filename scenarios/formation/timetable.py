"""A formation as data: who follows whom, and where everybody is wanted when."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from cosim.errors import CosimError
from cosim.scenario.settings import Settings
from scenarios.formation.topology import HEAD, Offsets, Place, Spacing, offsets, places, topology

SHORTEST_CHANGE = 6.0
"""Time [s] that a change of shape takes at least (engineering choice)."""
_SHIFT_SPEED, _SHIFT_ACCELERATION = 6.0, 1.5
"""Largest speed [m/s] and acceleration [m/s2] of a place while the shape changes (engineering choice)."""
Shapes = Sequence[tuple[float, str]]
"""When [s] the formation changes to which shape."""


@dataclass(frozen=True, slots=True)
class Transition:
    """From `time` [s] on the followers named in `offsets` are wanted at other places, seen from their leaders [m]."""

    time: float
    offsets: Offsets


@dataclass(frozen=True, slots=True)
class Formation:
    """`leaders` says whom each follower follows, by number of the follower; the head follows nobody.

    `offsets` are where followers are wanted at the start, about `initial_error` [m] beside which they are, and
    `timetable` says where later. `in_a_row`: everybody drives behind the car with the next lower number. Raises
    CosimError for a place of a car that follows nobody. `trailing`: places are in axes that trail from the leader's
    hand, not in its body axes. A change takes at least `duration` [s].
    """

    leaders: Mapping[int, int]
    offsets: Offsets
    timetable: Sequence[Transition] = ()
    in_a_row: bool = False
    initial_error: float = 0.0
    trailing: bool = False
    duration: float = SHORTEST_CHANGE

    def __post_init__(self) -> None:
        for transition in (Transition(0.0, self.offsets), *self.timetable):
            for k in transition.offsets:
                if k not in self.leaders:
                    raise CosimError(
                        f"car {k} follows nobody in this formation and cannot be given a place at {transition.time:g} s"
                    )

    @property
    def cars(self) -> tuple[int, ...]:
        """The numbers of all cars, the head first."""
        return HEAD, *self.leaders


def arranged(shapes: Shapes, settings: Settings) -> Formation:
    """The formation that the settings describe; at the times of `shapes` all move into others.

    With frame = head all follow the head, in axes that trail from it; else who follows whom remains that of the
    topology. All take the same time for a change, as long as the one with the longest way needs. Raises CosimError for
    a topology or a shape there is none of.
    """
    kind, size = topology(settings["topology"]), int(settings["vehicles"])
    spacing, trailing = Spacing(settings["spacing"], settings["lateral_spacing"]), settings["frame"] == "head"
    leaders = dict.fromkeys(range(HEAD + 1, size + 1), HEAD) if trailing else kind.leaders(size)

    def seen(shape: str) -> Offsets:
        return offsets(leaders, places(shape, size, spacing))

    ways = [places(shape, size, spacing) for shape in (kind.shape, *(shape for _, shape in shapes))]

    return Formation(
        leaders=leaders,
        offsets=seen(kind.shape),
        timetable=[Transition(time, seen(shape)) for time, shape in shapes],
        in_a_row=kind.in_a_row,
        initial_error=settings["initial_error"],
        trailing=trailing,
        duration=common_duration(ways),
    )


def common_duration(shapes: Sequence[Mapping[int, Place]]) -> float:
    """How long [s] every change from one of `shapes` (places [m] by car) to the next takes, for all cars alike.

    A quintic over a way D in T reaches 15/8 D/T and 10/sqrt(3) D/T^2. Cars that took times of their own would have
    places that run into one another, and along a chain their accelerations would add up.
    """
    ways = [math.dist(a[k], b[k]) for a, b in pairwise(shapes) for k in a]
    D = max(ways, default=0.0)
    return max(SHORTEST_CHANGE, 15 / 8 * D / _SHIFT_SPEED, math.sqrt(10 / math.sqrt(3) * D / _SHIFT_ACCELERATION))
