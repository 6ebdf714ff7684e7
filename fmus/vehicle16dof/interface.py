"""What Vehicle16Dof shows: actuators, road and disturbances in, motion and tyre forces out."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import AXES, Variable, continuous, group, input_, load_parameters, output
from fmus.cars.wheels import FRONT, WHEELS, motor_available
from fmus.vehicle16dof.balance import SINKS, SOURCES, STORES

MAX_SUBSTEP = 0.001

_INPUTS: list[Variable] = [
    *group(
        input_, "wheel_torque", WHEELS, "N.m", "motor torque on the wheel, positive drives", minimum=-2e4, maximum=2e4
    ),
    *group(input_, "brake_torque", WHEELS, "N.m", "friction brake torque, never reverses", minimum=0.0, maximum=2e4),
    *motor_available("part of its torque that the motor gives: 1 while it works, 0 when it is lost"),
    *group(input_, "steer_torque", FRONT, "N.m", "torque about the kingpin, positive left", minimum=-5e3, maximum=5e3),
    *group(input_, "suspension_force", WHEELS, "N", "active force, positive lifts the body", minimum=-5e4, maximum=5e4),
    *group(input_, "road_friction", WHEELS, "1", "road friction factor", start=1.0, minimum=0.01, maximum=2.0),
    *group(input_, "road_height", WHEELS, "m", "road height under the wheel", minimum=-100.0, maximum=100.0),
    *group(input_, "body_force", AXES, "N", "external force at O1 in the body frame", minimum=-1e6, maximum=1e6),
    *group(input_, "body_moment", AXES, "N.m", "external moment in the body frame", minimum=-1e6, maximum=1e6),
]

_OUTPUTS: list[Variable] = [
    *group(output, "position", AXES, "m", "position of O1 in the world"),
    output("roll", "rad", "roll angle, positive lifts the left side"),
    output("pitch", "rad", "pitch angle, positive lowers the nose"),
    output("yaw", "rad", "yaw angle in (-pi, pi], positive left"),
    *group(output, "velocity", AXES, "m/s", "velocity of O1 in the body frame"),
    *group(output, "angular_rate", AXES, "rad/s", "angular velocity in the body frame"),
    *group(output, "acceleration", AXES, "m/s2", "acceleration of O1 against the world, in the body frame"),
    *group(output, "specific_force", AXES, "m/s2", "acceleration of O1 less gravity, in the body frame"),
    *group(output, "angular_acceleration", AXES, "rad/s2", "angular acceleration in the body frame"),
    output("sideslip", "rad", "sideslip angle of O1, positive when it moves to its left; fades out below 0.5 m/s"),
    *group(output, "suspension_travel", WHEELS, "m", "suspension travel, positive in bump"),
    *group(output, "suspension_rate", WHEELS, "m/s", "suspension travel rate"),
    *group(output, "steer_angle", FRONT, "rad", "steering angle, positive left"),
    *group(output, "steer_rate", FRONT, "rad/s", "steering rate"),
    *group(output, "wheel_angle", WHEELS, "rad", "angle the wheel has turned, positive forward"),
    *group(output, "wheel_speed", WHEELS, "rad/s", "wheel spin, positive forward"),
    *group(output, "tyre_force_x", WHEELS, "N", "longitudinal force on the tyre in its contact frame"),
    *group(output, "tyre_force_y", WHEELS, "N", "lateral force on the tyre in its contact frame"),
    *group(output, "tyre_force_z", WHEELS, "N", "normal force on the tyre"),
    *group(output, "slip_ratio", WHEELS, "1", "longitudinal slip after relaxation"),
    *group(output, "slip_angle", WHEELS, "rad", "slip angle after relaxation"),
    *(output(f"energy.{name}", "J", text) for name, text in STORES.items()),
    *(output(f"power.{name}", "W", text) for name, text in (SOURCES | SINKS).items()),
]

INTERFACE = continuous(
    "Vehicle16Dof",
    "Multibody car of 16 degrees of freedom: chassis, suspensions, steering, wheels, tyres with relaxation",
    step=0.001,
    max_substep=MAX_SUBSTEP,
    variables=[*load_parameters(Path(__file__).with_name("parameters.toml")), *_INPUTS, *_OUTPUTS],
)
