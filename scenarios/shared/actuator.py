"""What the high-level controller assumes of the low-level one."""

from __future__ import annotations

from cosim.model.configuration import Configuration
from fmus.controllers.high_level_lqr.interface import ACTUATOR


def tell_the_actuator(configuration: Configuration, car: str = "") -> None:
    """What delays a command in llc is what hlc assumes of it (`actuator.*`), unless hlc was told otherwise."""
    for name in ACTUATOR:
        configuration.follow(f"{car}hlc", f"actuator.{name}", f"{car}llc.{name}")
