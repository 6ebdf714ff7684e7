"""What ConstraintFollower shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Advice, Variable, group, input_, load_parameters, output, sampled
from fmus.controllers.bus import SAMPLE, trajectory_bus
from fmus.controllers.formation import bus

KINDS = ("offset", "distance", "trajectory", "heading")
"""Switches `constraint.*`."""
ROWS = ("offset.x", "offset.y", "distance", "trajectory.x", "trajectory.y", "heading")
"""The rows of C, vectors in world axes."""
_NONE = "no constraint is switched on: the follower goes on as it drives; set constraint.offset or another to true"


def _reference() -> list[Variable]:
    """Of the trajectory bus what is needed: the reference now."""
    wanted = {f"reference.{name}" for name in SAMPLE}
    return [port for port in trajectory_bus(input_) if port.name in wanted]


def _own() -> list[Variable]:
    text = "row of the constraints, world axes, 0 while it is off"
    return [
        output("command.yaw_acceleration", "rad/s2", "yaw acceleration, the rate of command.yaw_rate"),
        *group(output, "violation", ROWS, "m", f"C, in metres, {text}"),
        *group(output, "multiplier", ROWS, "m/s2", f"lambda for unit mass, {text}"),
        output("constraint.residual", "m/s2", "acceleration that the constraints ask for and cannot have together"),
        output("constraint.deficiency", "1", "number of rows that depend on others or, at coincident points, vanish"),
        output("constraint.none", "1", "1 while no constraint is switched on, else 0"),
        *group(output, "leader.acceleration", "xy", "m/s2", "rate of the leader's body velocity, filtered"),
        output("leader.yaw_acceleration", "rad/s2", "yaw acceleration of the leader, filtered"),
    ]


INTERFACE = sampled(
    "ConstraintFollower",
    "Formation keeping by the forces of constraints between vehicles: offset, distance, heading, or a trajectory",
    step=0.020,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *bus.follower_parameters(),
        *bus.follower_inputs(),
        *_reference(),
        *bus.follower_outputs(),
        *_own(),
    ],
    advice=[Advice("constraint.none", _NONE)],
)
