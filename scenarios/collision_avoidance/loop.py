"""The loop that drives the planned manoeuvre: ReferenceTrajectory plays it, MpcAllocator tracks it."""

from __future__ import annotations

import math

from cosim.errors import CosimError
from cosim.model.configuration import Configuration
from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.limit import Limit
from cosim.scenario.settings import Settings
from fmus.cars import published
from fmus.cars.grip import with_grip
from fmus.cars.wheels import WHEELS
from scenarios.collision_avoidance.evasion import Evasion, evasion
from scenarios.collision_avoidance.metrics import avoidance_metrics
from scenarios.shared.limits import SPUN
from scenarios.shared.sensors import TRUE_STATES, WHEEL_SPEEDS
from scenarios.shared.start import start_on_reference

_USED = 0.85
"""Part of the friction within which the wheel forces stay; MpcAllocator does not know that a longitudinal force takes
from the lateral one (engineering choice, enough for 8 m/s2)."""

_SAME = 1e-8
"""Relative and absolute tolerance of equal numbers; the plan keeps nine digits."""


def avoiding_system(_settings: Settings, planned: Evasion) -> System:
    """DoubleTrack with combined slip under MpcAllocator, which sees the true states and knows the friction.

    The wheel torques stand for motors and brakes together: there is no limit of power, and the wheels lock before a
    brake has given all it can.
    """
    mu = planned.encounter.friction
    system = System()
    system.add("plant", "DoubleTrack", {"tyre.combined_slip": True, **{f"road_friction.{w}": mu for w in WHEELS}})
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(planned.trajectory_file)})
    system.add(
        "mpc", "MpcAllocator", {"limit.force": 5000.0, "limit.power": 1e6, "limit.friction": _USED * mu, **_tyres(mu)}
    )
    system.connect("reference", "mpc")
    system.connect("plant", "mpc", TRUE_STATES | WHEEL_SPEEDS)
    system.connect("mpc", "plant")
    return system


def _tyres(mu: float) -> dict[str, float]:
    """What MpcAllocator assumes of the tyres on this road."""
    here = with_grip(published.single_track(), mu)
    return {
        f"design.tyre.{axle}.{name}": value
        for axle, tyre in (("front", here.front), ("rear", here.rear))
        for name, value in (("stiffness_factor", tyre.B), ("peak", tyre.D))
    }


def complete(configuration: Configuration, planned: Evasion) -> Evasion:
    """Start on the plan; raises CosimError where values of instances contradict what was decided for."""
    if configuration.value("reference", "trajectory_file") != str(planned.trajectory_file):
        raise CosimError("reference.trajectory_file is what the scenario plans; set scenario.* instead")
    start_on_reference(configuration)
    met = planned.encounter
    for wheel in WHEELS:
        _check(configuration, f"road_friction.{wheel}", met.friction, "friction")
    _check(configuration, "initial.speed", met.speed, "speed")
    _check(configuration, "initial.position.x", 0.0, "distance")
    return planned


def _check(configuration: Configuration, variable: str, decided: float, setting: str) -> None:
    """Raise CosimError when the plant's `variable` is not what was `decided` for by the `setting`."""
    given = configuration.number("plant", variable)
    if not math.isclose(given, decided, rel_tol=_SAME, abs_tol=_SAME):
        raise CosimError(
            f"plant.{variable} = {given:g} is not what the car decides and plans for ({decided:g}); "
            f"set scenario.{setting} instead"
        )


WORK = Work(
    prepare=evasion,
    build=avoiding_system,
    complete=complete,
    metrics=avoidance_metrics,
    limits=(
        Limit("hit the obstacle", "impact", most=0),
        Limit("left the road", "road_margin_min", least=0),
        SPUN,
    ),
    picture="scenarios.collision_avoidance.picture",
)
