"""The time-optimal double lane change of chapter 3, tracked by MpcAllocator."""

from dataclasses import replace

from cosim.scenario.definition import Scenario
from cosim.scenario.settings import NumberSetting, Setting
from scenarios.shared.settings import SENSORS

_DISTURBANCES = {
    "lateral_offset": NumberSetting(0.0, -1.0, 1.0, "m", "start to the left of the plan"),
    "yaw_offset": NumberSetting(0.0, -0.2, 0.2, "rad", "yaw angle at the start, beyond the plan's"),
    "speed_offset": NumberSetting(0.0, -3.0, 3.0, "m/s", "speed at the start, beyond the plan's"),
    "side_force": NumberSetting(0.0, -3000.0, 3000.0, "N", "constant force on the car to its left"),
}
"""Settings of what disturbs the drive."""

PLANAR = Scenario(
    name="double-lane-change",
    title="Time-optimal double lane change of a planar car with four driven wheels, started 0.3 m beside the plan",
    figures="Figs. 3.11 to 3.13, of Fig. 3.14 the MPC signals (concept of Fig. 3.3, path of Fig. 3.4)",
    stop_time=7.5,
    module="scenarios.lane_change.planar",
    settings=_DISTURBANCES | {"lateral_offset": replace(_DISTURBANCES["lateral_offset"], default=0.3)},
)
MULTIBODY = Scenario(
    name="double-lane-change-16dof",
    title="Time-optimal double lane change of the multibody car, planned for it, steering servos and active suspension",
    figures="those of double-lane-change, on the car of chapter 4",
    stop_time=8.0,
    module="scenarios.lane_change.multibody",
    settings={**SENSORS, **_DISTURBANCES},
)
MOTOR_FAILURE = Scenario(
    name="motor-failure",
    title="Double lane change of the planar car that loses one of its four motors half-way",
    figures="the path of Fig. 3.4 with the distribution of Figs. 3.11 and 3.12 after the loss of a motor",
    stop_time=7.6,
    module="scenarios.lane_change.motor_failure",
    settings={
        "motor": Setting("rr", ("fl", "fr", "rl", "rr"), "the wheel whose motor is lost"),
        "loss": Setting("found", ("found", "told"), "the controller finds the loss in the wheel speeds, or is told"),
        "failure_time": NumberSetting(4.0, 0.0, 7.0, "s", "when it is lost"),
        **_DISTURBANCES,
    },
)
