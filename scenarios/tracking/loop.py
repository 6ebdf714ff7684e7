"""The tracking loop shared by the scenarios of chapter 4: plant, sensors, filter, reference and both controllers."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial

from cosim.model.configuration import Configuration
from cosim.model.face import Value
from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from scenarios.shared.actuator import tell_the_actuator
from scenarios.shared.limits import INCONSISTENT, SATURATED, SPUN, off_path
from scenarios.shared.sensors import TRUE_RATES, add_sensors, feed_back
from scenarios.shared.start import start_on_reference
from scenarios.tracking.metrics import tracking_metrics

LIMITS = (off_path(1.0), SPUN, SATURATED, *INCONSISTENT)


def tracking(reference: Mapping[str, Value]) -> Work:
    """What a tracking scenario does, whose manoeuvre is the parameter set `reference` of ReferenceTrajectory."""
    return Work(
        build=partial(tracking_system, reference),
        complete=complete,
        metrics=tracking_metrics,
        limits=LIMITS,
        picture="scenarios.tracking.picture",
    )


def tracking_system(reference: Mapping[str, Value], settings: Settings, _prepared: None) -> System:
    """The closed loop."""
    system = System()
    system.add("plant", "Vehicle16Dof")
    add_sensors(system, settings)
    system.add("reference", "ReferenceTrajectory", reference)
    system.add("hlc", "HighLevelLqr")
    system.add("llc", "LowLevelPid")
    system.connect("reference", "hlc")
    system.connect("hlc", "llc")
    system.connect("plant", "llc")
    system.connect("llc", "plant")
    feed_back(system, settings, "hlc", {})
    feed_back(system, settings, "llc", TRUE_RATES)
    return system


def complete(configuration: Configuration, _prepared: None) -> None:
    """What follows from the user's values: the start on the reference, and what hlc assumes of llc."""
    start_on_reference(configuration)
    tell_the_actuator(configuration)
