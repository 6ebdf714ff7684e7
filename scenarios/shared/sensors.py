"""Sensors and the filter of a car: which there are, how they are wired, and who sees what.

Instances are named after their car: `car` is a prefix like "car2.", empty where there is but one.
"""

from __future__ import annotations

from collections.abc import Mapping

from cosim.model.system import System
from cosim.scenario.settings import Settings
from fmus.estimator.profiles import profile as filter_profile
from fmus.sensors.gps.profiles import profile as gps_profile
from fmus.sensors.imu.profiles import profile as imu_profile

TRUE_YAW_RATE = {"yaw_rate": "angular_rate.z"}
# Body rates stand in for the rates of yaw, roll and pitch, which `estimate.*_rate` are: with roll and pitch of a few
# degrees they differ by terms like yaw' sin(pitch), below 0.02 rad/s here.
TRUE_RATES = {**TRUE_YAW_RATE, "roll_rate": "angular_rate.x", "pitch_rate": "angular_rate.y"}
_RIGID = 1e12  # N/m, assumed of the tyres of a planar car, which does not lean
TRUE_STATES = {"estimate.": "", "estimate.yaw_rate": "angular_rate.z"}
"""For `System.connect`: a plant's states in place of an estimate."""
WHEEL_SPEEDS = {"wheel_speed.": "wheel_speed."}
"""For `System.connect`: what a plant's wheels show, which no filter hides."""


def add_sensors(system: System, settings: Settings, car: str = "", *, sprung: bool = True) -> None:
    """`imu`, `gps` and `filter`, which knows their profiles, on the car's `plant`; a planar one is not `sprung`."""
    gps, imu = settings["gps_profile"], settings["imu_profile"]
    system.add(f"{car}imu", "Imu", imu_profile(imu))
    system.add(f"{car}gps", "GpsReceiver", gps_profile(gps))
    stiff = {} if sprung else {"design.tyre_stiffness": _RIGID}
    system.add(f"{car}filter", "NavigationFilter", filter_profile(gps, imu) | stiff)
    system.connect(f"{car}plant", f"{car}imu", {"truth.": ""})
    system.connect(f"{car}plant", f"{car}gps", {"truth.": ""})
    for source in ("imu", "gps", "plant") if sprung else ("imu", "gps"):
        system.connect(f"{car}{source}", f"{car}filter")


def feed_back(system: System, settings: Settings, listener: str, rates: Mapping[str, str], car: str = "") -> None:
    """`listener` sees how its own car moves, as its `estimate.*`; `rates` are those it wants of the true ones."""
    tell(system, settings, f"{car}{listener}", "estimate.", rates, car)


def tell(
    system: System, settings: Settings, listener: str, inputs: str, rates: Mapping[str, str], car: str = ""
) -> None:
    """`listener` gets in its inputs `inputs`* how `car` moves: what is known of it, of the truth those `rates`."""
    source, outputs = known(settings, car)
    true = {} if outputs else {f"{inputs}{rate}": output for rate, output in rates.items()}
    system.connect(source, listener, {inputs: outputs, **true})


def known(settings: Settings, car: str = "") -> tuple[str, str]:
    """The instance that says how `car` moves, and how its outputs begin: the filter's estimate, or the plant's states.

    With feedback=truth the sensors and the filter run along, but nobody listens.
    """
    return (f"{car}filter", "estimate.") if settings["feedback"] == "filter" else (f"{car}plant", "")
