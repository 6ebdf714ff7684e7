"""The follower bus: the ports and parameters every follower of a formation has, whatever its law.

Leader L, follower i. `formation.x/y` is the wanted place of the follower's O1 in the leader's body frame when both are
aligned; the hand point lies `hand.distance` ahead of O1.
"""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Variable, group, input_, load_parameters, output
from fmus.cars.design_parameters import design_parameters

DESIGN = ("mass", "l_f", "l_r", "cornering_front", "cornering_rear", "pneumatic_trail", "gravity")
"""Parameters `design.*` of every follower."""
_FURTHEST = 1e5  # m; beyond it an offset is not a place in a formation


def follower_parameters() -> list[Variable]:
    """Hand point, headway, limits, link and realisation, then the assumed car (`design.*`)."""
    return [*load_parameters(Path(__file__).with_name("parameters.toml")), *design_parameters(DESIGN)]


def follower_inputs() -> list[Variable]:
    """The newest message of the leader, the own estimate and the wanted place; all angles may be wrapped."""
    return [*_leader(), *_estimate(), *_formation()]


def follower_outputs(*, led_back: bool = False) -> list[Variable]:
    """Commands as LowLevelPid takes them, error of the hand point, and what is limited or lost.

    With `led_back` the place jumps where the follower is found far from it (`catch_up.py`).
    """
    place = "place of O1 in the leader's body axes wanted now, with headway; smooth"
    if led_back:
        place += ", but a follower further off than catch_up.distance finds it near, in one jump"
    return [
        output("command.speed", "m/s", "forward speed"),
        output("command.acceleration", "m/s2", "longitudinal acceleration, the rate of command.speed"),
        output("command.yaw_rate", "rad/s", "yaw rate"),
        output("command.steer_feedforward", "rad", "steering angle that gives command.yaw_rate in a steady turn"),
        *group(output, "error", "xy", "m", "actual minus wanted place of the hand point in the follower's body axes"),
        *group(output, "offset", "xy", "m", place),
        output("saturation.speed", "1", "1 while speed or acceleration are limited, else 0"),
        output("saturation.yaw_rate", "1", "1 while the yaw rate is limited, else 0"),
        output("link.lost", "1", "1 while the leader is not heard, else 0"),
    ]


def _leader() -> list[Variable]:
    return [
        *group(input_, "leader.position", "xy", "m", "world position of the leader's O1, newest message"),
        input_("leader.yaw", "rad", "yaw angle of the leader, newest message"),
        *group(input_, "leader.velocity", "xy", "m/s", "velocity of the leader's O1 in its body axes, newest message"),
        input_("leader.yaw_rate", "rad/s", "yaw rate of the leader, newest message"),
        input_("leader.age", "s", "how old the newest message is", minimum=0.0),
        input_("leader.valid", "1", "1 once there is a message, else 0", 1.0, minimum=0.0, maximum=1.0),
    ]


def _estimate() -> list[Variable]:
    return [
        *group(input_, "estimate.position", "xy", "m", "own world position of O1"),
        input_("estimate.yaw", "rad", "own yaw angle"),
        *group(input_, "estimate.velocity", "xy", "m/s", "own velocity of O1 in body axes"),
        input_("estimate.yaw_rate", "rad/s", "own yaw rate"),
    ]


def _formation() -> list[Variable]:
    text = "wanted place of the own O1 in the leader's body axes"
    return [
        *group(input_, "formation", "xy", "m", text, minimum=-_FURTHEST, maximum=_FURTHEST),
        input_("feedforward.speed", "m/s", "newest speed broadcast by the head of the formation"),
        input_(
            "feedforward.valid",
            "1",
            "1 once that was heard, else 0: feedforward.speed is then nothing",
            1.0,
            minimum=0.0,
            maximum=1.0,
        ),
    ]
