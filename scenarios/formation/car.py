"""One car of a formation: plant, sensors, filter and, unless it is kinematic, the low-level controller."""

from __future__ import annotations

from cosim.model.system import System
from cosim.scenario.settings import Settings
from scenarios.formation.settings import PLANTS
from scenarios.shared.sensors import TRUE_RATES, add_sensors, feed_back

_LAGS = {"speed.lag": 0.1, "yaw_rate.lag": 0.1}
"""Of a unicycle: about what the other plants take with their low-level controller (engineering choice)."""
_LOW_LEVEL = {"filter.speed": 60.0, "yaw.pole": 16.0}
"""Of the low-level controller (engineering choice). A follower closes loops around speed and yaw rate, in which every
delay counts: a speed 3/60 s late instead of 3/20 s, and a yaw rate controlled twice as fast, without which the noise of
the messages makes an adaptive follower swing at 30 m/s."""
_PLANAR = {"suspension.enabled": False, "steering.enabled": False}
"""Of the low-level controller of a planar car, which has neither springs nor servos."""


def add_car(system: System, settings: Settings, car: str, brain: str) -> None:
    """Add the car whose instances begin with `car`; its `brain`, an instance that commands it, is already there.

    `settings` are `plant` and those of the sensors.
    """
    kind, plant = settings["plant"], f"{car}plant"
    system.add(plant, PLANTS[kind], _LAGS if kind == "unicycle" else {})
    add_sensors(system, settings, car, sprung=kind == "16dof")
    if kind == "unicycle":
        system.connect(f"{car}{brain}", plant)
    else:
        _add_low_level(system, settings, car, brain, planar=kind == "double-track")


def _add_low_level(system: System, settings: Settings, car: str, brain: str, *, planar: bool) -> None:
    plant, llc = f"{car}plant", f"{car}llc"
    system.add(llc, "LowLevelPid", {**(_PLANAR if planar else {}), **_LOW_LEVEL})
    system.connect(f"{car}{brain}", llc)
    system.connect(plant, llc)
    system.connect(llc, plant, {"": "", "command.steer_angle": "steer_demand"} if planar else None)
    feed_back(system, settings, "llc", TRUE_RATES, car)
