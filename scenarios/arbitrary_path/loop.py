"""A road planned while driving: RecedingHorizonPlanner, MpcAllocator and the planar car, which sees the true states."""

from __future__ import annotations

from cosim.model.configuration import Configuration
from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from scenarios.arbitrary_path.metrics import arbitrary_path_metrics, given_up
from scenarios.arbitrary_path.road import LaidRoad, half_width, lay
from scenarios.shared.limits import LEFT_ROAD, SPUN
from scenarios.shared.sensors import TRUE_STATES, WHEEL_SPEEDS
from scenarios.shared.start import Offset, beside, start_at

_GRIP = 0.85
_LIMITS = {
    "limit.front_brake": 3000.0,
    "limit.rear_brake": 1500.0,
    "limit.sideslip": 0.08,
    "tyre.friction": 0.8,
}
"""The plan uses this part of the peak forces of the tyres, and less braking and sideslip than possible, so that the
controller can correct: the single-track car knows no load transfer, and brakes where it has no grip left to steer."""


def prepare(settings: Settings) -> Settings:
    """The settings, which `complete` needs: the road can be laid only when the values of the planner are known."""
    return settings


def build(_settings: Settings, _prepared: Settings) -> System:
    """Planner, controller and car; longitudinal forces cost the car lateral ones, as the planner expects."""
    system = System()
    system.add("plant", "DoubleTrack", {"tyre.combined_slip": True})
    system.add("planner", "RecedingHorizonPlanner", _LIMITS)
    system.add("mpc", "MpcAllocator")
    system.connect("plant", "planner", TRUE_STATES)
    system.connect("planner", "mpc")
    system.connect("plant", "mpc", TRUE_STATES | WHEEL_SPEEDS)
    system.connect("mpc", "plant")
    return system


def complete(configuration: Configuration, settings: Settings) -> LaidRoad:
    """The road as the planner has it; the car starts where the planner does, `lateral_offset` to the left."""
    _leave_room(configuration, settings["margin"])
    laid = lay(configuration)
    start_at(configuration, beside(laid.start, Offset(lateral=settings["lateral_offset"])))
    return laid


def _leave_room(configuration: Configuration, margin: float) -> None:
    """The plan keeps `margin` [m] more from the edges than the car must, and leaves some grip to the controller."""
    configuration.default("planner", "road.clearance", half_width(configuration) + margin)
    for peak in ("design.tyre.front.peak", "design.tyre.rear.peak"):
        configuration.default("planner", peak, _GRIP * configuration.number("planner", peak))


WORK = Work(
    prepare=prepare,
    build=build,
    complete=complete,
    metrics=arbitrary_path_metrics,
    limits=(LEFT_ROAD, SPUN),
    failure=given_up,
    picture="scenarios.arbitrary_path.picture",
)
