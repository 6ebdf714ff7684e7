"""The tracking loop shared by the scenarios of chapter 4: plant, sensors, filter, reference and both controllers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cosim.model.face import Value
from cosim.model.system import System
from cosim.scenario import Scenario, Settings
from scenarios.shared.catalogue import fmu_path
from scenarios.shared.sensors import SETTINGS, TRUE_RATES, add_sensors, feed_back
from scenarios.shared.start import start_on_reference
from scenarios.shared.tracking_errors import tracking_metrics


def tracking(name: str, title: str, figures: str, stop_time: float, reference: Mapping[str, Value]) -> Scenario:
    """A tracking scenario, whose manoeuvre is the parameter set `reference` of ReferenceTrajectory."""
    return Scenario(
        name=name,
        title=title,
        figures=figures,
        stop_time=stop_time,
        build=lambda settings: tracking_system(settings, reference),
        complete=complete,
        find=fmu_path,
        metrics=tracking_metrics,
        draw=_draw,
        settings=SETTINGS,
    )


def tracking_system(settings: Settings, reference: Mapping[str, Value]) -> System:
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


def complete(system: System, _settings: Settings) -> None:
    """What follows from the user's values: the start on the reference, and what hlc assumes of llc."""
    start_on_reference(system)
    tell_the_actuator(system)


def tell_the_actuator(system: System, car: str = "") -> None:
    """Values set of llc are those that hlc assumes of it (`actuator.*`), unless hlc was told otherwise."""
    from fmus.controllers.high_level_lqr.interface import ACTUATOR  # noqa: PLC0415  (lazy: `cosim list`)

    assumed, given = (system.instances[f"{car}{name}"].parameters for name in ("hlc", "llc"))
    for name in ACTUATOR:
        if name in given:
            assumed.setdefault(f"actuator.{name}", given[name])


def _draw(results, file: Path, title: str) -> None:  # type: ignore[no-untyped-def]
    from scenarios.tracking.picture import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
