"""Named parameter sets of Imu, from profiles.toml. Imports no casadi."""

from __future__ import annotations

from pathlib import Path

from fmukit.profiles import load_profiles
from fmus.sensors.imu.interface import INTERFACE

PROFILES = load_profiles(Path(__file__).with_name("profiles.toml"), INTERFACE)


def profile(name: str) -> dict[str, float]:
    """The parameters of the profile `name`; ValueError lists the known names."""
    return PROFILES[name]
