"""What Imu shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import AXES, Variable, group, input_, load_parameters, output, sampled


def _truth() -> list[Variable]:
    return [
        *group(input_, "truth.velocity", AXES, "m/s", "true velocity of O1, body frame"),
        *group(input_, "truth.acceleration", AXES, "m/s2", "true acceleration of O1 against the world, body frame"),
        *group(input_, "truth.specific_force", AXES, "m/s2", "true specific force at O1, body frame"),
        *group(input_, "truth.angular_rate", AXES, "rad/s", "true angular velocity, body frame"),
        *group(input_, "truth.angular_acceleration", AXES, "rad/s2", "true angular acceleration, body frame"),
    ]


def _readings() -> list[Variable]:
    return [
        *group(output, "accelerometer", AXES, "m/s2", "measured mean specific force at the sensor, body frame"),
        *group(output, "gyroscope", AXES, "rad/s", "measured angular velocity, body frame"),
    ]


INTERFACE = sampled(
    "Imu",
    "Inertial measurement unit: noise, turn-on bias, bias walk, scale error, range, resolution and lever arm",
    step=0.005,
    variables=[*load_parameters(Path(__file__).with_name("parameters.toml")), *_truth(), *_readings()],
    noise=12,
)
