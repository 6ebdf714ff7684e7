"""What Radio shows."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from fmukit.interface import Variable, group, input_, load_parameters, output, sampled

PLANE = ("x", "y")


def _motion(make: Callable[..., Variable], name: str, of: str) -> list[Variable]:
    return [
        *group(make, f"{name}.position", PLANE, "m", f"{of}: position of O1, world frame"),
        make(f"{name}.yaw", "rad", f"{of}: yaw, in (-pi, pi] when received"),
        *group(make, f"{name}.velocity", PLANE, "m/s", f"{of}: velocity of O1, body frame"),
        make(f"{name}.yaw_rate", "rad/s", f"{of}: time derivative of yaw"),
    ]


INTERFACE = sampled(
    "Radio",
    "Vehicle-to-vehicle messages about the motion of a car: sent at their own rate, received late, noisy, some lost",
    step=0.010,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *_motion(input_, "message", "what the sender knows of itself now"),
        *_motion(output, "leader", "newest message received"),
        output("leader.age", "s", "time since the newest message received was sent; before any, since the start"),
        output("leader.count", "1", "number of messages received so far"),
        output("leader.valid", "1", "1 once a message has been received"),
    ],
    noise=7,
)
