"""A formation as data: who follows whom, and where everybody is wanted when."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from cosim.errors import CosimError
from cosim.scenario.settings import Settings
from scenarios.formation.topology import HEAD, Offsets, Spacing, offsets, places, topology

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
    CosimError for a place of a car that follows nobody.
    """

    leaders: Mapping[int, int]
    offsets: Offsets
    timetable: Sequence[Transition] = ()
    in_a_row: bool = False
    initial_error: float = 0.0

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

    Who follows whom remains that of the topology. Raises CosimError for a topology or a shape there is none of.
    """
    kind, size = topology(settings["topology"]), int(settings["vehicles"])
    leaders, spacing = kind.leaders(size), Spacing(settings["spacing"], settings["lateral_spacing"])

    def seen(shape: str) -> Offsets:
        return offsets(leaders, places(shape, size, spacing))

    return Formation(
        leaders=leaders,
        offsets=seen(kind.shape),
        timetable=[Transition(time, seen(shape)) for time, shape in shapes],
        in_a_row=kind.in_a_row,
        initial_error=settings["initial_error"],
    )
