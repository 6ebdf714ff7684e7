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


_PARTS = {"position": "m", "velocity": "m/s", "heading": "rad"}


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
        make("gps.velocity_delay", "s", "how much before gps.time the velocity of that fix was taken"),
        make("gps.valid", "1", "1 while the newest due fix was good, 0 before the first and while fixes are lost"),
        *(_there(make, part) for part in _PARTS),
        *(
            make(f"gps.{part}_accuracy", unit, f"standard deviation of the {part}, slow errors included; 0: not told")
            for part, unit in _PARTS.items()
        ),
    ]


def _there(make: Callable[..., Variable], part: str) -> Variable:
    """An input nobody connects says that the part is there."""
    options = {"start": 1.0} if make is input_ else {}
    return make(f"gps.{part}_valid", "1", f"1 while the newest reported fix has a {part}", **options)


INTERFACE = sampled(
    "GpsReceiver",
    "Satellite receiver: position, velocity and heading with noise, accuracy, latency, outages and lever arm",
    step=0.010,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *_truth(),
        *gps_bus(output),
        output("gps.age", "s", "gps.time seen from the receiver's newest sample: how old the newest reported fix is"),
    ],
    noise=11,
)
