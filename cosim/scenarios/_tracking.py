"""The tracking loop shared by the scenarios of chapter 4: plant, sensors, filter, reference and both controllers."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cosim.face import Value
from cosim.scenario import Scenario, Setting, Settings
from cosim.scenarios._catalogue import fmu_path
from cosim.scenarios._start import start_on_reference
from cosim.scenarios._tracking_metrics import tracking_metrics
from cosim.system import System

SETTINGS = {
    "feedback": Setting("filter", ("filter", "truth"), "what the controllers see: the filter's estimate or the truth"),
    "gps_profile": Setting("rtk", ("rtk", "dgps", "standalone"), "kind of satellite receiver"),
    "imu_profile": Setting("automotive", ("automotive", "tactical"), "grade of the inertial unit"),
}
# Body rates stand in for the rates of yaw, roll and pitch, which `estimate.*_rate` are: with roll and pitch of a few
# degrees they differ by terms like yaw' sin(pitch), below 0.02 rad/s here.
_TRUE_RATES = {
    "estimate.yaw_rate": "angular_rate.z",
    "estimate.roll_rate": "angular_rate.x",
    "estimate.pitch_rate": "angular_rate.y",
}


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
    """The closed loop. With feedback=truth the sensors and the filter run along, but nobody listens."""
    from fmus.estimator.profiles import profile as filter_profile  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.sensors.gps.profiles import profile as gps_profile  # noqa: PLC0415
    from fmus.sensors.imu.profiles import profile as imu_profile  # noqa: PLC0415

    gps, imu = settings["gps_profile"], settings["imu_profile"]
    system = System()
    system.add("plant", "Vehicle16Dof")
    system.add("imu", "Imu", imu_profile(imu))
    system.add("gps", "GpsReceiver", gps_profile(gps))
    system.add("filter", "NavigationFilter", filter_profile(gps, imu))
    system.add("reference", "ReferenceTrajectory", reference)
    system.add("hlc", "HighLevelLqr")
    system.add("llc", "LowLevelPid")
    _wire_sensors(system)
    _wire_controllers(system)
    _wire_feedback(system, settings["feedback"])
    return system


def complete(system: System, _settings: Settings) -> None:
    """What follows from the user's values: the start on the reference, and what hlc assumes of llc."""
    start_on_reference(system)
    tell_the_actuator(system)


def tell_the_actuator(system: System) -> None:
    """Values set of llc are those that hlc assumes of it (`actuator.*`), unless hlc was told otherwise."""
    from fmus.controllers.high_level_lqr.interface import ACTUATOR  # noqa: PLC0415  (lazy: `cosim list`)

    assumed, given = system.instances["hlc"].parameters, system.instances["llc"].parameters
    for name in ACTUATOR:
        if name in given:
            assumed.setdefault(f"actuator.{name}", given[name])


def _wire_sensors(system: System) -> None:
    system.connect("plant", "imu", {"truth.": ""})
    system.connect("plant", "gps", {"truth.": ""})
    system.connect("imu", "filter")
    system.connect("gps", "filter")
    system.connect("plant", "filter")


def _wire_controllers(system: System) -> None:
    system.connect("reference", "hlc")
    system.connect("hlc", "llc")
    system.connect("plant", "llc")
    system.connect("llc", "plant")


def _wire_feedback(system: System, feedback: str) -> None:
    if feedback == "filter":
        system.connect("filter", "hlc")
        system.connect("filter", "llc")
    else:
        system.connect("plant", "hlc", {"estimate.": ""})
        system.connect("plant", "llc", {"estimate.": "", **_TRUE_RATES})


def _draw(results, file: Path, title: str) -> None:  # type: ignore[no-untyped-def]
    from cosim.scenarios._tracking_overview import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
