"""What is made of the settings of a platoon once: who drives where, what happens to it, and how its head drives."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from cosim.scenario.settings import Settings
from scenarios.formation.timetable import Formation, arranged
from scenarios.platoon.events import Span, changes_until, spans
from scenarios.platoon.head import head_file
from scenarios.platoon.row import hand_distances, with_merge

_PUSHED = 3


@dataclass(frozen=True, slots=True)
class Platoon:
    """A `formation` in a row, and the `events` that happen to it, by name.

    `pushed` is the number of the car that is pushed, if one is. `trajectory` is the file the head follows.
    `hand_distances` [m] are by number of the follower. Changes of formation are measured up to `changes_until` [s].
    """

    formation: Formation
    events: Mapping[str, Span]
    pushed: int
    trajectory: Path
    hand_distances: Mapping[int, float]
    changes_until: float

    @property
    def leaders(self) -> Mapping[int, int]:
        """Whom each follower follows, by number of the follower."""
        return self.formation.leaders


def prepare(settings: Settings) -> Platoon:
    """Raises CosimError when the trajectory of the head cannot be kept."""
    events, formation = spans(settings["manoeuvre"]), arranged((), {**settings, "frame": "neighbour"})
    return Platoon(
        formation=with_merge(formation, settings, events["merge"].begin) if "merge" in events else formation,
        events=events,
        pushed=min(_PUSHED, int(settings["vehicles"])),
        trajectory=head_file(events),
        hand_distances=hand_distances(formation, settings),
        changes_until=changes_until(settings["manoeuvre"]),
    )
