"""The double lane change in time-optimal motion: planned before the drive, tracked by MpcAllocator.

Three levels: the plan (fmus/planner) played by ReferenceTrajectory, the predictive controller that tracks it, and its
distribution of forces to four wheels.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from cosim.model.system import System
from cosim.results.reading import Results
from cosim.scenario import NumberSetting, Settings
from scenarios.shared.plans import planned
from scenarios.shared.sensors import TRUE_STATES
from scenarios.shared.start import Offset, start_on_reference

if TYPE_CHECKING:
    from fmus.planner.road import Corridor
    from fmus.planner.vehicle import Vehicle

INTERVALS = 160


def perturbations(lateral: float = 0.0) -> dict[str, NumberSetting]:
    """Settings of what disturbs the drive; `lateral` is the default offset of the start."""
    return {
        "lateral_offset": NumberSetting(lateral, -1.0, 1.0, "m", "start to the left of the plan"),
        "yaw_offset": NumberSetting(0.0, -0.2, 0.2, "rad", "yaw angle at the start, beyond the plan's"),
        "speed_offset": NumberSetting(0.0, -3.0, 3.0, "m/s", "speed at the start, beyond the plan's"),
        "side_force": NumberSetting(0.0, -3000.0, 3000.0, "N", "constant force on the car to its left"),
    }


def corridor(margin: float = 0.0) -> Corridor:
    """The double lane change of the planner; its free width is less by `margin` [m] on both sides.

    The thesis names this test path (3.3.1), its Delta and d; what these measure is an engineering choice.
    """
    from fmus.planner.road import double_lane_change  # noqa: PLC0415  (lazy: `cosim list`)

    road = double_lane_change()
    return replace(road, clearance=road.clearance + margin)


def lane_change_plan(vehicle: Vehicle | None = None, margin: float = 0.0) -> Path:
    """The planned trajectory, of the published car unless `vehicle` is given."""
    from fmus.planner.planned_cars import thesis  # noqa: PLC0415

    return planned("double-lane-change", vehicle or thesis().vehicle, corridor(margin), INTERVALS)


def planar_loop(settings: Settings, margin: float = 0.0) -> System:
    """DoubleTrack under MpcAllocator, which sees the true states."""
    system = System()
    system.add("plant", "DoubleTrack", {"body_force.y": settings["side_force"]})
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(lane_change_plan(margin=margin))})
    system.add("mpc", "MpcAllocator")
    system.connect("reference", "mpc")
    system.connect("plant", "mpc", TRUE_STATES)
    system.connect("mpc", "plant")
    return system


def start_beside_plan(system: System, settings: Settings) -> None:
    """The car starts as far from the plan as the settings say."""
    offset = Offset(settings["lateral_offset"], settings["yaw_offset"], settings["speed_offset"])
    start_on_reference(system, offset)


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from scenarios.lane_change.picture import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
