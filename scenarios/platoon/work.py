"""What the platoon scenario does: the system of cars in a row on a straight, and what happens to them."""

from __future__ import annotations

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from scenarios.formation.complete import complete_formation
from scenarios.formation.limits import LIMITS
from scenarios.formation.system import formation_system
from scenarios.formation.topology import HEAD, prefix
from scenarios.platoon.laws import LED, law_of
from scenarios.platoon.metrics import platoon_metrics
from scenarios.platoon.prepare import Platoon, prepare

_REMEDIES = "give more scenario.headway (0.5 s is enough), or use scenario.topology=star"
_FORCE, _FORCE_TIME = -6000.0, 1.0  # N, s


def build(settings: Settings, platoon: Platoon) -> System:
    """The platoon and what happens to it."""
    reference = {"trajectory_file": str(platoon.trajectory)}
    system = formation_system(law_of(settings), reference, settings, platoon.formation)
    for k, distance in platoon.hand_distances.items():
        system.set(f"{prefix(k)}follower.hand.distance", distance)
    if "push" in platoon.events:
        force, begin = f"{prefix(platoon.pushed)}plant.body_force.x", platoon.events["push"].begin
        system.at(begin, force, _FORCE)
        system.at(begin + _FORCE_TIME, force, 0.0)
    return system


def complete(configuration: Configuration, platoon: Platoon) -> Platoon:
    """As in every formation; raises CosimError for another trajectory of the head than is measured."""
    if configuration.value(f"{prefix(HEAD)}reference", "trajectory_file") != str(platoon.trajectory):
        raise CosimError(
            f"{prefix(HEAD)}reference.trajectory_file is the manoeuvre of the scenario; set scenario.manoeuvre"
        )
    complete_formation(configuration, platoon.formation, LED, _REMEDIES)
    return platoon


WORK = Work(
    prepare=prepare,
    build=build,
    complete=complete,
    metrics=platoon_metrics,
    limits=LIMITS,
    picture="scenarios.formation.picture",
)
