"""The double lane change of the planar car, in which a motor is lost half-way."""

from __future__ import annotations

from functools import partial

from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from scenarios.lane_change.metrics import motor_failure_metrics
from scenarios.lane_change.plan import LaneChange, start_beside_plan
from scenarios.lane_change.planar import planar_lane_change, planar_system
from scenarios.shared.limits import LEFT_ROAD, SPUN

_MARGIN = 0.1
"""Distance [m] by which the plan keeps off the edges of the corridor, for the feedback to use."""


def failing_system(settings: Settings, change: LaneChange) -> System:
    """The planar system with the event of the failure, which the controller is told at once or has to find."""
    system = planar_system(settings, change)
    for instance in ("plant", "mpc") if settings["loss"] == "told" else ("plant",):
        system.at(settings["failure_time"], f"{instance}.motor_available.{settings['motor']}", 0.0)
    return system


WORK = Work(
    prepare=partial(planar_lane_change, margin=_MARGIN),
    build=failing_system,
    complete=start_beside_plan,
    metrics=motor_failure_metrics,
    limits=(LEFT_ROAD, SPUN),
    picture="scenarios.lane_change.picture",
)
