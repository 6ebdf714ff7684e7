"""What GpsReceiver shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fmukit.interface import AXES, Variable, group, input_, load_parameters, output, sampled


def _truth() -> list[Variable]:
    return [
        *group(input_, "truth.position", AXES, "m", "true position of O1, world frame"),
        *group(input_, "truth.velocity", AXES, "m/s", "true velocity of O1, body frame"),
        *(input_(f"truth.{angle}", "rad", f"true {angle}") for angle in ("roll", "pitch", "yaw")),
        *group(input_, "truth.angular_rate", AXES, "rad/s", "true angular velocity, body frame"),
    ]


def gps_bus(make: Callable[..., Variable]) -> list[Variable]:
    """The receiver's signals, made with `make` (`input_` or `output`)."""
    return [
        *group(make, "gps.position", AXES, "m", "reported position of the main antenna, world frame"),
        *group(make, "gps.velocity", AXES, "m/s", "reported velocity of the main antenna, world frame"),
        make("gps.heading", "rad", "reported direction from the main to the front antenna, as a yaw angle"),
        make("gps.fix_count", "1", "number of fixes reported so far"),
        make(
            "gps.time", "s", "instant at which the newest reported fix was taken, counted from the start; 0 before any"
        ),
        make("gps.valid", "1", "1 while the newest due fix was good, 0 before the first and while fixes are lost"),
    ]


INTERFACE = sampled(
    "GpsReceiver",
    "Dual-antenna satellite receiver: position, velocity and heading with noise, latency, outages and lever arm",
    step=0.010,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *_truth(),
        *gps_bus(output),
        output("gps.age", "s", "gps.time seen from the receiver's newest sample: how old the newest reported fix is"),
    ],
    noise=11,
)
