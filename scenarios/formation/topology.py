"""Formations as data: who follows whom, and where everybody drives, for any number of cars.

Cars are numbered from 1, the head. A place is (x, y) [m] in the head's body axes while all cars are aligned: x is
negative behind the head, y positive to its left.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from cosim.errors import unknown

HEAD = 1
Place = tuple[float, float]
Offsets = Mapping[int, Place]
"""By number of the follower: its place seen from the car it follows."""


@dataclass(frozen=True, slots=True)
class Spacing:
    """Distance of one rank from the next [m] and of one file from the next [m]."""

    along: float = 12.0
    across: float = 4.0


def prefix(k: int) -> str:
    """How the names of the instances of car k begin."""
    return f"car{k}."


Leader = Callable[[int], int]
Shape = Callable[[int], Place]
"""Of car k: its leader, and its place in ranks behind the head and files to the left."""


def _line(k: int) -> Place:
    """One behind the other."""
    return 1.0 - k, 0.0


def _v(k: int) -> Place:
    """Two arms: even numbers to the left, odd ones to the right."""
    rank = k // 2
    return -float(rank), float(rank if k % 2 == 0 else -rank)


def _diamond(k: int) -> Place:
    """Groups of three behind each head: left, right, tail; the tail heads the next group."""
    group, member = divmod(k - 2, 3)
    if k == 1:
        return 0.0, 0.0
    return -2.0 * group - (1.0, 1.0, 2.0)[member], (1.0, -1.0, 0.0)[member]


def _left_wedge(k: int) -> Place:
    """One file further to the left with each rank."""
    return 1.0 - k, k - 1.0


def _right_wedge(k: int) -> Place:
    return 1.0 - k, 1.0 - k


SHAPES: Mapping[str, Shape] = {
    "line": _line,
    "v": _v,
    "diamond": _diamond,
    "left-wedge": _left_wedge,
    "right-wedge": _right_wedge,
}


@dataclass(frozen=True, slots=True)
class Topology:
    """`leader` of car k > 1, and the shape a formation of this kind starts in."""

    leader: Leader
    shape: str

    @property
    def in_a_row(self) -> bool:
        """Whether everybody drives behind the car with the next lower number, at the start."""
        return self.shape == "line"

    def leaders(self, size: int) -> dict[int, int]:
        """By number of the follower: the car it follows."""
        return {k: self.leader(k) for k in range(2, size + 1)}


TOPOLOGIES: Mapping[str, Topology] = {
    "chain": Topology(lambda k: k - 1, "line"),
    "star": Topology(lambda _k: 1, "line"),
    "v": Topology(lambda k: max(1, k - 2), "v"),
    "diamond": Topology(lambda k: 1 + 3 * ((k - 2) // 3), "diamond"),
}


def topology(name: str) -> Topology:
    """The topology called `name`; raises CosimError with those there are."""
    if name not in TOPOLOGIES:
        raise unknown("topology", name, TOPOLOGIES)
    return TOPOLOGIES[name]


def places(shape: str, size: int, spacing: Spacing) -> dict[int, Place]:
    """Places [m] of all cars; raises CosimError for a shape there is none of."""
    if shape not in SHAPES:
        raise unknown("shape of a formation", shape, SHAPES)
    ranks = {k: SHAPES[shape](k) for k in range(1, size + 1)}
    return {k: (spacing.along * x, spacing.across * y) for k, (x, y) in ranks.items()}


def offsets(leaders: Mapping[int, int], wanted: Mapping[int, Place]) -> dict[int, Place]:
    """What each follower keeps from its leader so that all are at their wanted places."""
    return {k: (wanted[k][0] - wanted[leader][0], wanted[k][1] - wanted[leader][1]) for k, leader in leaders.items()}
