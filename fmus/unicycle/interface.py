"""What Unicycle shows: names, units and signs are those of Vehicle16Dof wherever both have a signal."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import AXES, continuous, group, input_, load_parameters, output

MAX_SUBSTEP = 0.010

_INPUTS = [
    input_("command.speed", "m/s", "speed asked for, positive forward", minimum=-1e3, maximum=1e3),
    input_("command.yaw_rate", "rad/s", "yaw rate asked for, positive left", minimum=-1e2, maximum=1e2),
    input_("body_force.x", "N", "external force at O1, forward", minimum=-1e6, maximum=1e6),
    input_("body_moment.z", "N.m", "external yaw moment", minimum=-1e6, maximum=1e6),
]

_OUTPUTS = [
    *group(output, "position", AXES, "m", "position of O1 in the world"),
    output("roll", "rad", "roll angle, zero: the vehicle is planar"),
    output("pitch", "rad", "pitch angle, zero: the vehicle is planar"),
    output("yaw", "rad", "yaw angle in (-pi, pi], positive left"),
    *group(output, "velocity", AXES, "m/s", "velocity of O1 in the body frame"),
    *group(output, "angular_rate", AXES, "rad/s", "angular velocity in the body frame"),
    *group(output, "acceleration", AXES, "m/s2", "acceleration of O1 against the world, in the body frame"),
    *group(output, "specific_force", AXES, "m/s2", "acceleration of O1 less gravity, in the body frame"),
    *group(output, "angular_acceleration", AXES, "rad/s2", "angular acceleration in the body frame"),
    output("sideslip", "rad", "sideslip angle of O1, zero: the vehicle moves where it points"),
]

INTERFACE = continuous(
    "Unicycle",
    "Kinematic vehicle that moves where it points: speed and yaw rate follow their commands, at once or with a lag",
    step=0.001,
    max_substep=MAX_SUBSTEP,
    variables=[*load_parameters(Path(__file__).with_name("parameters.toml")), *_INPUTS, *_OUTPUTS],
)
