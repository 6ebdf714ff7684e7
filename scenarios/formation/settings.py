"""What every scenario of cars in formation offers as settings, and what it records. Light to import."""

from __future__ import annotations

from cosim.scenario.settings import NumberSetting, Setting
from scenarios.formation.topology import TOPOLOGIES
from scenarios.shared.settings import SENSORS

PLANTS = {"16dof": "Vehicle16Dof", "double-track": "DoubleTrack", "unicycle": "Unicycle"}
"""Models of the plant, by the name they have in the setting."""
RECORD_EVERY = 0.02
"""Seconds from row to row: the period of the followers. A row every millisecond would be gigabytes for ten cars."""
UNRECORDED = ("**.fl", "**.fr", "**.rl", "**.rr")
"""What belongs to single wheels: a third of all signals, and of the memory of many cars."""
_MOST = 100
FRAMES = ("head", "neighbour")


def formation_settings(vehicles: int, kind: str, spacing: float = 12.0) -> dict[str, Setting | NumberSetting]:
    """The settings of a formation: of `vehicles` cars, topology `kind` and `spacing` [m] unless told otherwise."""
    return {
        "vehicles": NumberSetting(vehicles, 1, _MOST, "1", "number of cars, the head included", whole=True),
        "topology": Setting(
            kind, tuple(TOPOLOGIES), "the shape at the start; with frame=neighbour also who follows whom"
        ),
        "frame": Setting("head", FRAMES, "places in axes that trail from the head, or in those of the car followed"),
        "plant": Setting("16dof", tuple(PLANTS), "what drives"),
        **SENSORS,
        "radio": Setting("on", ("on", "off"), "messages at 10 Hz, late and noisy; off: known at once"),
        "headway": NumberSetting(0.0, 0.0, 3.0, "s", "the wanted place moves back by this times the own speed"),
        "feedforward": Setting("off", ("on", "off"), "the head broadcasts its speed to all followers"),
        "spacing": NumberSetting(spacing, 6.0, 100.0, "m", "from rank to rank, O1 to O1"),
        "lateral_spacing": NumberSetting(4.0, 2.5, 20.0, "m", "from file to file"),
        "initial_error": NumberSetting(0.0, 0.0, 10.0, "m", "how far followers start beside their places, about"),
    }
