"""What NavigationFilter shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import AXES, Advice, Variable, group, input_, load_parameters, output, parameter, sampled
from fmus.cars.nominal import DESIGN
from fmus.cars.wheels import WHEELS
from fmus.estimator.profiles import profile
from fmus.sensors.gps.interface import gps_bus

_SENSOR_DATA = {
    "noise.gyroscope": ("rad/s/sqrt(Hz)", "white noise density of the gyroscope"),
    "noise.gyroscope_bias": ("rad/s/sqrt(s)", "random walk of the gyroscope bias"),
    "noise.accelerometer": ("m/s2/sqrt(Hz)", "white noise density of the accelerometer"),
    "noise.accelerometer_bias": ("m/s2/sqrt(s)", "random walk of the accelerometer bias"),
    "initial.std.gyroscope_bias": ("rad/s", "standard deviation of the gyroscope bias at start"),
    "initial.std.accelerometer_bias": ("m/s2", "standard deviation of the accelerometer bias at start"),
    "noise.gps_position": ("m", "standard deviation of the white position error, per axis"),
    "noise.gps_correlated": ("m", "standard deviation of the slowly varying position error, per axis"),
    "noise.gps_correlation_time": ("s", "correlation time of the slowly varying position error"),
    "noise.gps_velocity": ("m/s", "standard deviation of the velocity error, per axis"),
    "noise.gps_heading": ("rad", "standard deviation of the heading error"),
    **{f"imu.position.{axis}": ("m", f"assumed place of the inertial unit from O1, {axis}") for axis in AXES},
    **{f"antenna.position.{axis}": ("m", f"assumed place of the main antenna from O1, {axis}") for axis in AXES},
}
_DESIGN = {
    "mass": ("kg", "assumed mass of the car"),
    "cog_height": ("m", "assumed height of the centre of gravity"),
    "track": ("m", "assumed track"),
    "wheelbase": ("m", "assumed wheelbase"),
    "tyre_stiffness": ("N/m", "assumed vertical stiffness of one tyre; 1e12: a car that does not lean"),
    "rolling_radius": ("m", "assumed rolling radius of the rear wheels"),
}
REAR = WHEELS[2:]
_DERIVED = {
    "rear_axle": ("m", "assumed distance of the rear axle behind O1", DESIGN.l_r),
    "rear_compliance": (
        "rad.s2/m",
        "assumed sideslip of the rear axle per lateral acceleration: m l_f / (L C_r)",
        DESIGN.mass * DESIGN.l_f / (DESIGN.wheelbase * DESIGN.cornering_rear),
    ),
}


def _parameters() -> list[Variable]:
    sensors, source = profile(), "start value of the sensor of the same kind"
    return [
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *(
            parameter(n, unit, text, sensors[n], minimum=_least(n), source=source)
            for n, (unit, text) in _SENSOR_DATA.items()
        ),
        *(
            parameter(f"design.{n}", unit, text, getattr(DESIGN, n), minimum=1e-3, source="nominal car")
            for n, (unit, text) in _DESIGN.items()
        ),
        *(
            parameter(f"design.{n}", unit, text, value, minimum=0.0, source="nominal car")
            for n, (unit, text, value) in _DERIVED.items()
        ),
    ]


def _least(name: str) -> float | None:
    """Places may be negative; assumed receiver errors must not vanish, they are divided by."""
    if ".position." in name:
        return None
    return 1e-6 if "gps" in name and name != "noise.gps_correlated" else 0.0


def _inputs() -> list[Variable]:
    return [
        *group(input_, "accelerometer", AXES, "m/s2", "measured mean specific force at the sensor, body frame"),
        *group(input_, "gyroscope", AXES, "rad/s", "measured angular velocity, body frame"),
        *gps_bus(input_),
        *group(input_, "suspension_travel", WHEELS, "m", "suspension travel, bump > 0"),
        *group(input_, "wheel_speed", REAR, "rad/s", "wheel spin, positive forward; used with wheels.used"),
    ]


def _estimates() -> list[Variable]:
    return [
        *group(output, "estimate.position", "xy", "m", "position of O1, world frame"),
        output("estimate.yaw", "rad", "yaw, in (-pi, pi]"),
        *group(output, "estimate.velocity", "xy", "m/s", "velocity of O1, body frame"),
        output("estimate.yaw_rate", "rad/s", "time derivative of yaw, bias removed"),
        output("estimate.roll", "rad", "roll"),
        output("estimate.pitch", "rad", "pitch"),
        output("estimate.roll_rate", "rad/s", "time derivative of roll, bias removed"),
        output("estimate.pitch_rate", "rad/s", "time derivative of pitch, bias removed"),
        output("estimate.sideslip", "rad", "sideslip of O1; the forward speed counts as at least 1 m/s"),
        *group(output, "estimate.bias.gyroscope", AXES, "rad/s", "bias of the gyroscope"),
        *group(output, "estimate.bias.accelerometer", "xy", "m/s2", "bias of the accelerometer"),
    ]


def _quality() -> list[Variable]:
    return [
        *group(output, "std.position", "xy", "m", "standard deviation of the position estimate"),
        output("std.yaw", "rad", "standard deviation of the yaw estimate"),
        *group(output, "std.velocity", "xy", "m/s", "standard deviation of the velocity estimate"),
        output("std.roll", "rad", "standard deviation of the roll estimate"),
        output("std.pitch", "rad", "standard deviation of the pitch estimate"),
        output("nis.heading", "1", "normalised innovation squared of the last fix, heading (1 degree of freedom)"),
        output("nis.position", "1", "the same, position (2 degrees of freedom)"),
        output("nis.velocity", "1", "the same, velocity (2 degrees of freedom)"),
        output("fix.used_count", "1", "number of fixes used in full"),
        output("fix.refused_count", "1", "number of fixes refused, wholly or in part, as outliers or as too old"),
        output("fix.refused_for", "s", "time since a fix was refused without one used in full since; 0: none was"),
        output("fix.refused_long", "1", "1 while that is longer than 1 s and more than one was refused"),
    ]


INTERFACE = sampled(
    "NavigationFilter",
    "Two-stage Kalman filter: attitude and heading, then position and velocity; late fixes and lever arms handled",
    step=0.005,
    variables=[*_parameters(), *_inputs(), *_estimates(), *_quality()],
    advice=[
        Advice(
            "fix.refused_long",
            "fixes have been refused, wholly or in part, for more than 1 s; compare nis.* with gate.*, and check"
            " gps.time, the accuracies and antenna.position",
        )
    ],
)
