"""A formation of cars as a system: a head that tracks a trajectory, and followers that each keep their place.

Instances are named `car1.reference`, `car1.hlc`, ..., `car2.radio`, `car2.follower`, ...
"""

from __future__ import annotations

from collections.abc import Mapping

from cosim.model.face import Value
from cosim.model.system import System
from cosim.scenario.settings import Settings
from scenarios.formation.car import add_car
from scenarios.formation.law import Law
from scenarios.formation.timetable import Formation, Transition
from scenarios.formation.topology import HEAD, prefix
from scenarios.shared.sensors import TRUE_YAW_RATE, feed_back, known, tell


def formation_system(law: Law, reference: Mapping[str, Value], settings: Settings, formation: Formation) -> System:
    """The cars of the formation, whose head tracks what ReferenceTrajectory gives with the parameters `reference`.

    `settings` are `plant`, `feedback`, `gps_profile`, `imu_profile` of all cars, and `radio` ("on", "off"), `headway`
    [s] and `feedforward` ("on", "off") of the followers.
    """
    system = System()
    _add_head(system, settings, reference)
    for k, leader in formation.leaders.items():
        _add_follower(system, settings, law, k, formation)
        _hear_leader(system, settings, k, leader)
        if _hears_head(settings):
            _hear_head(system, settings, k)
    for transition in formation.timetable:
        _schedule(system, transition)
    return system


def _add_head(system: System, settings: Settings, reference: Mapping[str, Value]) -> None:
    car = prefix(HEAD)
    system.add(f"{car}reference", "ReferenceTrajectory", reference)
    system.add(f"{car}hlc", "HighLevelLqr")
    add_car(system, settings, car, "hlc")
    system.connect(f"{car}reference", f"{car}hlc")
    feed_back(system, settings, "hlc", {}, car)


def _add_follower(system: System, settings: Settings, law: Law, k: int, formation: Formation) -> None:
    car, ahead, place = prefix(k), _hears_head(settings), formation.offsets[k]
    wanted: dict[str, Value] = {
        "formation.x": place[0],
        "formation.y": place[1],
        "headway": settings["headway"],
        "feedforward.enabled": ahead,
        "frame.trailing": formation.trailing,
        "formation.duration": formation.duration,
    }
    system.add(f"{car}follower", law.model, {**wanted, **law.parameters, **(law.told if ahead else {})})
    add_car(system, settings, car, "follower")
    feed_back(system, settings, "follower", TRUE_YAW_RATE, car)


def _hears_head(settings: Settings) -> bool:
    return bool(settings["feedforward"] == "on")


def _hear_leader(system: System, settings: Settings, k: int, leader: int) -> None:
    """The follower of car k is told how its leader moves: by radio, or without one at once and without noise."""
    follower, radio = f"{prefix(k)}follower", f"{prefix(k)}radio"
    if settings["radio"] == "on":
        system.add(radio, "Radio")
        tell(system, settings, radio, "message.", TRUE_YAW_RATE, prefix(leader))
        system.connect(radio, follower)
    else:
        tell(system, settings, follower, "leader.", TRUE_YAW_RATE, prefix(leader))


def _hear_head(system: System, settings: Settings, k: int) -> None:
    """The follower of car k is told how fast the head of the formation is."""
    follower, radio = f"{prefix(k)}follower", f"{prefix(k)}broadcast"
    if settings["radio"] == "on":
        system.add(radio, "Radio")
        tell(system, settings, radio, "message.", TRUE_YAW_RATE, prefix(HEAD))
        system.connect(radio, follower, {"feedforward.speed": "leader.velocity.x", "feedforward.valid": "leader.valid"})
    else:
        source, outputs = known(settings, prefix(HEAD))
        system.connect(source, follower, {"feedforward.speed": f"{outputs}velocity.x"})


def _schedule(system: System, transition: Transition) -> None:
    for k, (x, y) in transition.offsets.items():
        system.at(transition.time, f"{prefix(k)}follower.formation.x", x)
        system.at(transition.time, f"{prefix(k)}follower.formation.y", y)
