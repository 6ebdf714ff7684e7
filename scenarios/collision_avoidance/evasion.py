"""What the car meets, what it decides to do, and the manoeuvre it plans: by fmus/planner/evasion, before the drive."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from pathlib import Path

from cosim.errors import CosimError
from cosim.scenario.settings import Settings
from fmus.planner import trajectory
from fmus.planner.errors import PlanningError
from fmus.planner.evasion import table
from fmus.planner.evasion.decision import Decision, decide
from fmus.planner.evasion.manoeuvre import manoeuvre
from fmus.planner.evasion.situation import Encounter, Surroundings
from scenarios.shared.plans import kept


@dataclass(frozen=True, slots=True)
class Evasion:
    """The `decision` for an `encounter` in `surroundings`, and the manoeuvre planned for it in `trajectory_file`."""

    encounter: Encounter
    surroundings: Surroundings
    decision: Decision
    trajectory_file: Path


def evasion(settings: Settings) -> Evasion:
    """For the encounter that the settings describe, each a field of `Encounter`.

    Raises CosimError for one that cannot be, or without a plan.
    """
    encounter, surroundings = Encounter(**settings), Surroundings()
    try:
        decision = decide(encounter, table.read(), surroundings)
        return Evasion(encounter, surroundings, decision, _planned(encounter, surroundings))
    except PlanningError as error:
        raise CosimError(str(error)) from error


def _planned(encounter: Encounter, surroundings: Surroundings) -> Path:
    """The trajectory file of the manoeuvre, from the cache if it was planned before."""

    def make(file: Path) -> None:
        trajectory.write_rows(manoeuvre(encounter, table.read(), surroundings).rows, file)

    parts: list[str | bytes] = [repr(asdict(encounter)), repr(asdict(surroundings)), table.FILE.read_bytes()]
    return kept("collision-avoidance", parts, make)
