"""The double lane change of the planar car.

Three levels: the plan (fmus/planner) played by ReferenceTrajectory, the predictive controller that tracks it, and its
distribution of forces to four wheels.
"""

from __future__ import annotations

from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from fmus.planner.planned_cars import thesis
from scenarios.lane_change.metrics import lane_change_metrics
from scenarios.lane_change.plan import LaneChange, lane_change, start_beside_plan
from scenarios.shared.limits import LEFT_ROAD, SPUN
from scenarios.shared.sensors import TRUE_STATES, WHEEL_SPEEDS


def planar_lane_change(settings: Settings, margin: float = 0.0) -> LaneChange:
    """That of the published car; the plan keeps `margin` [m] more from the edges than the car must."""
    return lane_change(settings, thesis().vehicle, margin)


def planar_system(settings: Settings, change: LaneChange) -> System:
    """DoubleTrack under MpcAllocator, which sees the true states."""
    system = System()
    system.add("plant", "DoubleTrack", {"body_force.y": settings["side_force"]})
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(change.trajectory_file)})
    system.add("mpc", "MpcAllocator")
    system.connect("reference", "mpc")
    system.connect("plant", "mpc", TRUE_STATES | WHEEL_SPEEDS)
    system.connect("mpc", "plant")
    return system


WORK = Work(
    prepare=planar_lane_change,
    build=planar_system,
    complete=start_beside_plan,
    metrics=lane_change_metrics,
    limits=(LEFT_ROAD, SPUN),
    picture="scenarios.lane_change.picture",
)
