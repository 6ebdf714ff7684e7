"""Sensors and the filter of a car: which there are, how they are wired, and who sees what."""

from __future__ import annotations

from cosim.scenario import Setting, Settings
from cosim.system import System

SETTINGS = {
    "feedback": Setting("filter", ("filter", "truth"), "what the controllers see: the filter's estimate or the truth"),
    "gps_profile": Setting("rtk", ("rtk", "dgps", "standalone"), "kind of satellite receiver"),
    "imu_profile": Setting("automotive", ("automotive", "tactical"), "grade of the inertial unit"),
}
TRUE_YAW_RATE = {"estimate.yaw_rate": "angular_rate.z"}
# Body rates stand in for the rates of yaw, roll and pitch, which `estimate.*_rate` are: with roll and pitch of a few
# degrees they differ by terms like yaw' sin(pitch), below 0.02 rad/s here.
TRUE_RATES = {**TRUE_YAW_RATE, "estimate.roll_rate": "angular_rate.x", "estimate.pitch_rate": "angular_rate.y"}


def add_sensors(system: System, settings: Settings) -> None:
    """`imu`, `gps` and `filter`, which knows their profiles, on the car `plant`."""
    from fmus.estimator.profiles import profile as filter_profile  # noqa: PLC0415  (lazy: `cosim list`)
    from fmus.sensors.gps.profiles import profile as gps_profile  # noqa: PLC0415
    from fmus.sensors.imu.profiles import profile as imu_profile  # noqa: PLC0415

    gps, imu = settings["gps_profile"], settings["imu_profile"]
    system.add("imu", "Imu", imu_profile(imu))
    system.add("gps", "GpsReceiver", gps_profile(gps))
    system.add("filter", "NavigationFilter", filter_profile(gps, imu))
    system.connect("plant", "imu", {"truth.": ""})
    system.connect("plant", "gps", {"truth.": ""})
    system.connect("imu", "filter")
    system.connect("gps", "filter")
    system.connect("plant", "filter")


def feed_back(system: System, settings: Settings, listener: str, rates: dict[str, str]) -> None:
    """`listener` sees the filter's estimate, or the plant's states with the body rates that `rates` names.

    With feedback=truth the sensors and the filter run along, but nobody listens.
    """
    if settings["feedback"] == "filter":
        system.connect("filter", listener)
    else:
        system.connect("plant", listener, {"estimate.": "", **rates})
