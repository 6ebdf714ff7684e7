"""The double lane change in time-optimal motion: its corridor, the plan made before the drive, a start beside the plan.

The thesis names this test path (3.3.1), its Delta and d; what these measure is an engineering choice.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from cosim.model.configuration import Configuration
from cosim.scenario.settings import Settings
from fmus.planner.road import Corridor, double_lane_change
from fmus.planner.vehicle import Vehicle
from scenarios.shared.plans import planned
from scenarios.shared.start import Offset, start_on_reference

_INTERVALS = 160


@dataclass(frozen=True, slots=True)
class LaneChange:
    """The `corridor`, the plan through it in `trajectory_file`, and how far from the plan the car starts.

    None is the corridor of a run whose reference is another trajectory.
    """

    corridor: Corridor | None
    trajectory_file: Path
    offset: Offset


def lane_change(settings: Settings, vehicle: Vehicle, margin: float = 0.0) -> LaneChange:
    """Planned for the `vehicle`; the plan keeps `margin` [m] more from the edges than the car must.

    Raises CosimError when there is no plan, or it cannot be kept.
    """
    corridor = double_lane_change()
    narrower = replace(corridor, clearance=corridor.clearance + margin)
    trajectory_file = planned("double-lane-change", vehicle, narrower, _INTERVALS)
    offset = Offset(settings["lateral_offset"], settings["yaw_offset"], settings["speed_offset"])
    return LaneChange(corridor, trajectory_file, offset)


def start_beside_plan(configuration: Configuration, change: LaneChange) -> LaneChange:
    """The car starts as far from the plan, or another trajectory if one is set, as the settings say."""
    start_on_reference(configuration, change.offset)
    if configuration.value("reference", "trajectory_file") != str(change.trajectory_file):
        return replace(change, corridor=None)
    return change
