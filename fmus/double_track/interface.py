"""What DoubleTrack shows: names, units and limits are those of Vehicle16Dof wherever both have a signal."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import AXES, Variable, continuous, group, input_, load_parameters, output
from fmus.cars import published
from fmus.cars.wheels import FRONT, WHEELS, motor_available

MAX_SUBSTEP = 0.001
PLANE = AXES[:2]

_INPUTS: list[Variable] = [
    *group(
        input_, "wheel_torque", WHEELS, "N.m", "motor torque on the wheel, positive drives", minimum=-2e4, maximum=2e4
    ),
    *group(input_, "brake_torque", WHEELS, "N.m", "friction brake torque, never reverses", minimum=0.0, maximum=2e4),
    *motor_available("part of its torque that the motor gives: 1 while it works, 0 when it is lost"),
    input_("command.steer_angle", "rad", "steering angle asked for, positive left", minimum=-2.0, maximum=2.0),
    *group(input_, "road_friction", WHEELS, "1", "road friction factor", start=1.0, minimum=0.01, maximum=2.0),
    *group(input_, "body_force", PLANE, "N", "external force at O1 in the body frame", minimum=-1e6, maximum=1e6),
    input_("body_moment.z", "N.m", "external yaw moment", minimum=-1e6, maximum=1e6),
]

_OUTPUTS: list[Variable] = [
    *group(output, "position", AXES, "m", "position of O1 in the world"),
    output("roll", "rad", "roll angle, zero: the car is planar"),
    output("pitch", "rad", "pitch angle, zero: the car is planar"),
    output("yaw", "rad", "yaw angle in (-pi, pi], positive left"),
    *group(output, "velocity", AXES, "m/s", "velocity of O1 in the body frame"),
    *group(output, "angular_rate", AXES, "rad/s", "angular velocity in the body frame"),
    *group(output, "acceleration", AXES, "m/s2", "acceleration of O1 against the world, in the body frame"),
    *group(output, "specific_force", AXES, "m/s2", "acceleration of O1 less gravity, in the body frame"),
    *group(output, "angular_acceleration", AXES, "rad/s2", "angular acceleration in the body frame"),
    output("sideslip", "rad", "sideslip angle of O1, positive when it moves to its left; fades out below 0.5 m/s"),
    *group(output, "steer_angle", FRONT, "rad", "steering angle, positive left"),
    *group(output, "steer_rate", FRONT, "rad/s", "steering rate"),
    *group(output, "wheel_speed", WHEELS, "rad/s", "wheel spin, positive forward"),
    *group(output, "tyre_force_x", WHEELS, "N", "longitudinal force on the tyre in its contact frame"),
    *group(output, "tyre_force_y", WHEELS, "N", "lateral force on the tyre in its contact frame"),
    *group(output, "tyre_force_z", WHEELS, "N", "normal force on the tyre"),
    *group(output, "slip_angle", WHEELS, "rad", "slip angle, positive when the wheel moves to its left"),
]

INTERFACE = continuous(
    "DoubleTrack",
    "Planar car with four driven wheels, load transfer and a steering actuator",
    step=0.001,
    max_substep=MAX_SUBSTEP,
    variables=[
        *published.double_track_parameters(),
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *_INPUTS,
        *_OUTPUTS,
    ],
)
