"""The double lane change in time-optimal motion: planned before the drive, tracked by MpcAllocator.

Three levels: the plan (fmus/planner) played by ReferenceTrajectory, the predictive controller that tracks it, and its
distribution of forces to four wheels.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cosim.results import Results
from cosim.scenario import NumberSetting, Settings
from cosim.scenarios._plans import planned
from cosim.scenarios._start import Offset, start_on_reference
from cosim.system import System

if TYPE_CHECKING:
    from fmus.planner.road import Corridor
    from fmus.single_track.data import Car

INTERVALS = 160
_TRANSITION, _CLEARANCE = 5.0, 0.84
"""Length of the corridor's steps and distance the centre of gravity keeps from its edges [m]."""
_TRUTH = {"estimate.": "", "estimate.yaw_rate": "angular_rate.z"}


def perturbations(lateral: float = 0.0) -> dict[str, NumberSetting]:
    """Settings of what disturbs the drive; `lateral` is the default offset of the start."""
    return {
        "lateral_offset": NumberSetting(lateral, -1.0, 1.0, "m", "start to the left of the plan"),
        "yaw_offset": NumberSetting(0.0, -0.2, 0.2, "rad", "yaw angle at the start, beyond the plan's"),
        "speed_offset": NumberSetting(0.0, -3.0, 3.0, "m/s", "speed at the start, beyond the plan's"),
        "side_force": NumberSetting(0.0, -3000.0, 3000.0, "N", "constant force on the car to its left"),
    }


def corridor(margin: float = 0.0) -> Corridor:
    """The corridor of the thesis; its free width is less by `margin` [m] on both sides."""
    from fmus.planner.road import double_lane_change  # noqa: PLC0415  (lazy: `cosim list`)

    return double_lane_change(_TRANSITION, _CLEARANCE + margin, width=2 * _CLEARANCE)


def lane_change_plan(car: Car | None = None, margin: float = 0.0) -> Path:
    """The planned trajectory, of the published car unless `car` is given."""
    from fmus.planner.vehicle import two_wheel_drive  # noqa: PLC0415
    from fmus.single_track.data import car as published  # noqa: PLC0415

    return planned("double-lane-change", two_wheel_drive(car or published()), corridor(margin), INTERVALS)


def planar_loop(settings: Settings, margin: float = 0.0) -> System:
    """DoubleTrack under MpcAllocator, which sees the true states."""
    system = System()
    system.add("plant", "DoubleTrack", {"body_force.y": settings["side_force"]})
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(lane_change_plan(margin=margin))})
    system.add("mpc", "MpcAllocator")
    system.connect("reference", "mpc")
    system.connect("plant", "mpc", _TRUTH)
    system.connect("mpc", "plant")
    return system


def start_beside_plan(system: System, settings: Settings) -> None:
    """The car starts as far from the plan as the settings say."""
    offset = Offset(settings["lateral_offset"], settings["yaw_offset"], settings["speed_offset"])
    start_on_reference(system, offset)


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from cosim.scenarios._lane_change_overview import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
