"""What the filter assumes of its sensors, derived from the sensors' own data sheets. Imports no casadi."""

from __future__ import annotations

from collections.abc import Mapping

from fmukit.interface import AXES, Interface
from fmus.sensors.gps.interface import INTERFACE as GPS
from fmus.sensors.gps.profiles import profile as gps_profile
from fmus.sensors.imu.interface import INTERFACE as IMU
from fmus.sensors.imu.profiles import profile as imu_profile

_SAME = {
    "noise.gyroscope": "gyroscope.noise_density",
    "noise.gyroscope_bias": "gyroscope.bias_walk",
    "noise.accelerometer": "accelerometer.noise_density",
    "noise.accelerometer_bias": "accelerometer.bias_walk",
    "initial.std.gyroscope_bias": "gyroscope.turn_on_bias",
    "initial.std.accelerometer_bias": "accelerometer.turn_on_bias",
    "noise.gps_position": "position.noise",
    "noise.gps_correlated": "position.correlated_noise",
    "noise.gps_correlation_time": "position.correlation_time",
    "noise.gps_velocity": "velocity.noise",
    **{f"{place}.position.{axis}": f"{place}.position.{axis}" for place in ("imu", "antenna") for axis in AXES},
}


def profile(gps: str = "rtk", imu: str = "automotive") -> dict[str, float]:
    """Filter parameters that match sensors of these profiles; ValueError lists the known names."""
    return assumed(imu_profile(imu), gps_profile(gps))


def assumed(imu: Mapping[str, float], gps: Mapping[str, float]) -> dict[str, float]:
    """Filter parameters that match sensors with these parameters (start values where not given)."""
    data = _starts(IMU) | _starts(GPS) | dict(imu) | dict(gps)
    matched: dict[str, float] = {ours: data[theirs] for ours, theirs in _SAME.items()}
    matched["noise.gps_heading"] = data["heading.noise"] / data["antenna.baseline"]
    return matched | {"course.used": data["antenna.count"] < 1.5}


def _starts(interface: Interface) -> dict[str, float]:
    return {v.name: float(v.start) for v in interface.select("parameter") if v.type == "Real"}
