"""What LowLevelPid shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Variable, group, input_, load_parameters, output, sampled
from fmus.cars.design_parameters import design_parameters
from fmus.cars.wheels import FRONT, WHEELS

_DESIGN = (
    *("mass", "sprung_mass", "roll_inertia", "pitch_inertia", "yaw_inertia", "l_f", "l_r", "track"),
    *("rolling_radius", "wheel_inertia", "cornering_front", "pneumatic_trail", "drag_area", "air_density", "gravity"),
    *("steer_inertia", "steer_damping", "rolling.constant", "rolling.linear", "rolling.quartic"),
)


def _commands() -> list[Variable]:
    return [
        input_("command.acceleration", "m/s2", "commanded longitudinal acceleration"),
        input_("command.speed", "m/s", "commanded forward speed"),
        input_("command.yaw_rate", "rad/s", "commanded yaw rate"),
        input_("command.steer_feedforward", "rad", "steering angle expected to give the commanded yaw rate"),
        input_("command.heave", "m", "commanded height of the body above its nominal height"),
        input_("command.roll", "rad", "commanded roll angle"),
        input_("command.pitch", "rad", "commanded pitch angle"),
        *group(input_, "command.wheel_torque", WHEELS, "N.m", "motor torque if fed through", minimum=-2e4, maximum=2e4),
        *group(input_, "command.brake_torque", WHEELS, "N.m", "brake torque if fed through", minimum=0.0, maximum=2e4),
        input_("command.steer_angle", "rad", "steering angle if fed through", minimum=-2.0, maximum=2.0),
    ]


def _measurements() -> list[Variable]:
    return [
        input_("estimate.velocity.x", "m/s", "forward speed of O1"),
        input_("estimate.velocity.y", "m/s", "speed of O1 to the left"),
        input_("estimate.yaw_rate", "rad/s", "yaw rate"),
        *group(input_, "estimate", ("roll", "pitch"), "rad", "attitude of the body"),
        *group(input_, "estimate", ("roll_rate", "pitch_rate"), "rad/s", "rate of the attitude of the body"),
        *group(input_, "steer_angle", FRONT, "rad", "measured steering angle"),
        *group(input_, "steer_rate", FRONT, "rad/s", "measured steering rate"),
        *group(input_, "wheel_speed", WHEELS, "rad/s", "measured wheel spin, positive forward"),
        *group(input_, "suspension_travel", WHEELS, "m", "suspension travel, positive in bump"),
        *group(input_, "suspension_rate", WHEELS, "m/s", "rate of the suspension travel"),
    ]


def _outputs() -> list[Variable]:
    return [
        *group(output, "wheel_torque", WHEELS, "N.m", "motor torque, positive drives"),
        *group(output, "brake_torque", WHEELS, "N.m", "friction brake torque, never negative"),
        *group(output, "steer_torque", FRONT, "N.m", "torque of the steering servo"),
        *group(output, "suspension_force", WHEELS, "N", "active suspension force, positive lifts the body"),
        *group(
            output, "saturation", ("drive", "steering", "suspension"), "1", "1 while the actuator is limited, else 0"
        ),
        *group(output, "saturation.wheel", WHEELS, "1", "1 while slip or motor limits the torque of the wheel, else 0"),
        output("filtered.speed", "m/s", "commanded speed after its D/S filter"),
        output("filtered.acceleration", "m/s2", "commanded acceleration after its D/S filter"),
        output("filtered.yaw_rate", "rad/s", "commanded yaw rate after its D/S filter"),
        output("steer_demand", "rad", "steering angle demanded of the servos at the middle of the axle"),
        output("heave", "m", "height of the body above its nominal height, from the suspension travel"),
    ]


INTERFACE = sampled(
    "LowLevelPid",
    "Speed, yaw rate, steering and active suspension control from selectable error differential equations",
    step=0.001,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *design_parameters(_DESIGN),
        *_commands(),
        *_measurements(),
        *_outputs(),
    ],
)
