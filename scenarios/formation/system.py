"""A formation of cars as a system: a head that tracks a trajectory, and followers that each keep their place.

Instances are named `car1.reference`, `car1.hlc`, ..., `car2.radio`, `car2.follower`, ...; all cars have a plant,
sensors, a filter and, unless they are kinematic, the low-level controller.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from cosim.errors import CosimError
from cosim.model.face import Value
from cosim.model.system import System
from cosim.scenario import Settings
from scenarios.formation.topology import Offsets, Spacing, offsets, places, topology
from scenarios.shared.sensors import TRUE_RATES, TRUE_YAW_RATE, add_sensors, feed_back, known, tell

HEAD = 1
PLANTS = {"16dof": "Vehicle16Dof", "double-track": "DoubleTrack", "unicycle": "Unicycle"}
Values = Mapping[str, Value]
LAGS: Values = {"speed.lag": 0.1, "yaw_rate.lag": 0.1}
"""Of a unicycle: about what the other plants take with their low-level controller (engineering choice)."""
LOW_LEVEL: Values = {"filter.speed": 60.0, "yaw.pole": 16.0}
"""Of all cars (engineering choice). A follower closes loops around speed and yaw rate, in which every delay counts: a
speed 3/60 s late instead of 3/20 s, and a yaw rate controlled twice as fast, without which the noise of the messages
makes an adaptive follower swing at 30 m/s."""


@dataclass(frozen=True, slots=True)
class Law:
    """How a follower keeps its place: its `model`, and values of its parameters beyond those of the settings.

    `motion`: it wants to know the velocity and yaw rate of its leader, not only where that is. `told` are parameters
    where the head broadcasts its speed.
    """

    model: str
    motion: bool
    parameters: Values = field(default_factory=dict)
    told: Values = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Change:
    """From `time` [s] on the followers named in `offsets` are wanted at other places, seen from their leaders [m]."""

    time: float
    offsets: Offsets


@dataclass(frozen=True, slots=True)
class Cars:
    """What the cars are made of: a key of PLANTS, and parameters of all low-level controllers and of the reference."""

    plant: str = "16dof"
    low_level: Values = field(default_factory=lambda: dict(LOW_LEVEL))
    reference: Values = field(default_factory=dict)


def name(k: int) -> str:
    """The prefix of the instances of car k."""
    return f"car{k}."


def change_of_shape(time: float, shape: str, size: int, kind: str, spacing: Spacing) -> Change:
    """At `time` [s] all followers move to another shape; who follows whom remains that of the topology `kind`."""
    return Change(time, offsets(topology(kind).leaders(size), places(shape, size, spacing)))


def formation(
    size: int, kind: str, law: Law, timetable: Sequence[Change], settings: Settings, cars: Cars, spacing: Spacing
) -> System:
    """`size` cars; `kind` says who follows whom and the shape they start in.

    `settings` are `feedback`, `gps_profile`, `imu_profile` of the sensors, and `radio` ("on", "off"), `headway` [s] and
    `feedforward` ("on", "off") of the followers. Raises CosimError for a topology there is none of, for less than one
    car, and for a change of a car that follows nobody.
    """
    if size < 1:
        raise CosimError(f"a formation of {size} cars is none; give at least one")
    system, leaders = System(), topology(kind).leaders(size)
    _add_head(system, settings, cars)
    start = offsets(leaders, places(topology(kind).shape, size, spacing))
    for k, leader in leaders.items():
        _add_follower(system, settings, cars, law, k, leader, start[k])
    for change in timetable:
        _schedule(system, change, leaders)
    return system


def _add_head(system: System, settings: Settings, cars: Cars) -> None:
    car = name(HEAD)
    system.add(f"{car}reference", "ReferenceTrajectory", cars.reference)
    system.add(f"{car}hlc", "HighLevelLqr")
    _add_car(system, settings, cars, car, "hlc")
    system.connect(f"{car}reference", f"{car}hlc")
    feed_back(system, settings, "hlc", {}, car)


def _add_follower(
    system: System, settings: Settings, cars: Cars, law: Law, k: int, leader: int, offset: tuple[float, float]
) -> None:
    car, follower = name(k), f"{name(k)}follower"
    place = {"formation.x": offset[0], "formation.y": offset[1]}
    ahead = settings["feedforward"] == "on"
    wanted: dict[str, Value] = {**place, "headway": settings["headway"], "feedforward.enabled": ahead}
    system.add(follower, law.model, {**wanted, **law.parameters, **(law.told if ahead else {})})
    _add_car(system, settings, cars, car, "follower")
    feed_back(system, settings, "follower", TRUE_YAW_RATE, car)
    _hear_leader(system, settings, law, k, leader)
    if ahead:
        _hear_head(system, settings, k)


def _hear_leader(system: System, settings: Settings, law: Law, k: int, leader: int) -> None:
    """The follower of car k is told how its leader moves: by radio, or without one at once and without noise."""
    follower, radio = f"{name(k)}follower", f"{name(k)}radio"
    if settings["radio"] == "on":
        system.add(radio, "Radio")
        tell(system, settings, radio, "message.", TRUE_YAW_RATE, name(leader))
        system.connect(radio, follower)
    else:
        tell(system, settings, follower, "leader.", TRUE_YAW_RATE if law.motion else {}, name(leader))


def _hear_head(system: System, settings: Settings, k: int) -> None:
    """The follower of car k is told how fast the head of the formation is."""
    follower, radio = f"{name(k)}follower", f"{name(k)}broadcast"
    if settings["radio"] == "on":
        system.add(radio, "Radio")
        tell(system, settings, radio, "message.", TRUE_YAW_RATE, name(HEAD))
        system.connect(radio, follower, {"feedforward.speed": "leader.velocity.x", "feedforward.valid": "leader.valid"})
    else:
        source, outputs = known(settings, name(HEAD))
        system.connect(source, follower, {"feedforward.speed": f"{outputs}velocity.x"})


def _add_car(system: System, settings: Settings, cars: Cars, car: str, brain: str) -> None:
    """Plant, sensors, filter, and between plant and `brain` the low-level controller, which a unicycle has not."""
    plant = f"{car}plant"
    system.add(plant, PLANTS[cars.plant], LAGS if cars.plant == "unicycle" else {})
    add_sensors(system, settings, car, sprung=cars.plant == "16dof")
    if cars.plant == "unicycle":
        system.connect(f"{car}{brain}", plant)
        return
    llc, planar = f"{car}llc", cars.plant == "double-track"
    system.add(llc, "LowLevelPid", {**(_PLANAR if planar else {}), **cars.low_level})
    system.connect(f"{car}{brain}", llc)
    system.connect(plant, llc)
    system.connect(llc, plant, {"": "", "command.steer_angle": "steer_demand"} if planar else None)
    feed_back(system, settings, "llc", TRUE_RATES, car)


_PLANAR: Values = {"suspension.enabled": False, "steering.enabled": False}
"""Of the low-level controller of a planar car, which has neither springs nor servos."""


def _schedule(system: System, change: Change, leaders: Mapping[int, int]) -> None:
    for k, (x, y) in change.offsets.items():
        if k not in leaders:
            raise CosimError(
                f"car {k} follows nobody in this formation and cannot be given a place at {change.time:g} s"
            )
        system.at(change.time, f"{name(k)}follower.formation.x", x)
        system.at(change.time, f"{name(k)}follower.formation.y", y)
