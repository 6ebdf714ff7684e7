"""The double lane change of the multibody car, planned for that car."""

from __future__ import annotations

from cosim.model.configuration import Configuration
from cosim.model.system import System
from cosim.scenario.definition import Work
from cosim.scenario.settings import Settings
from fmus.cars.derived import double_track_values
from fmus.cars.nominal import DESIGN
from fmus.planner.planned_cars import multibody
from scenarios.lane_change.metrics import multibody_metrics
from scenarios.lane_change.plan import LaneChange, lane_change, start_beside_plan
from scenarios.shared.limits import LEFT_ROAD, SATURATED, SPUN
from scenarios.shared.sensors import TRUE_RATES, TRUE_YAW_RATE, WHEEL_SPEEDS, add_sensors, feed_back

_SERVOS = 0.02
"""Time constant [s] the controller assumes of the steering servos, behind the filter of their demand."""
_CALM = {"weight.steer_change": 1000.0, "integral.gain": 0.1}
"""Of the controller: the noise of the estimate reaches the steering three times less than by its start values."""


def prepare(settings: Settings) -> LaneChange:
    """The plan leaves some of the car's grip to the controller."""
    return lane_change(settings, multibody(DESIGN).vehicle)


def multibody_system(settings: Settings, change: LaneChange) -> System:
    """Vehicle16Dof under MpcAllocator, whose commands pass through LowLevelPid; sensors and filter in the loop."""
    system = System()
    system.add("plant", "Vehicle16Dof", {"body_force.y": settings["side_force"]})
    add_sensors(system, settings)
    system.add("reference", "ReferenceTrajectory", {"trajectory_file": str(change.trajectory_file)})
    assumed = {f"design.{name}": value for name, value in double_track_values(DESIGN).items()}
    system.add("mpc", "MpcAllocator", assumed | _CALM)
    system.add("llc", "LowLevelPid", {"speed.fed_through": True, "yaw.fed_through": True})
    system.connect("reference", "mpc")
    system.connect(
        "mpc", "llc", {"command.wheel_torque.": "wheel_torque.", "command.steer_angle": "command.steer_angle"}
    )
    system.connect("plant", "mpc", WHEEL_SPEEDS)
    system.connect("plant", "llc")
    system.connect("llc", "plant")
    feed_back(system, settings, "mpc", TRUE_YAW_RATE)
    feed_back(system, settings, "llc", TRUE_RATES)
    return system


def complete(configuration: Configuration, change: LaneChange) -> LaneChange:
    """The start, and what mpc assumes of the steering: limits and filter of llc, unless it was told otherwise."""
    configuration.follow("mpc", "actuator.steer_rate", of="llc.steering.rate_limit")
    configuration.follow("mpc", "actuator.steer_limit", of="llc.steering.angle_limit")
    lag = configuration.number("llc", "steering.filter_time") + _SERVOS
    configuration.default("mpc", "actuator.steer_lag", lag, of=["llc.steering.filter_time"])
    return start_beside_plan(configuration, change)


WORK = Work(
    prepare=prepare,
    build=multibody_system,
    complete=complete,
    metrics=multibody_metrics,
    limits=(LEFT_ROAD, SPUN, SATURATED),
    picture="scenarios.lane_change.picture",
)
