"""What HighLevelLqr shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Variable, group, input_, load_parameters, output, parameter, sampled
from fmus.cars.design_parameters import design_parameters
from fmus.controllers.bus import trajectory_bus
from fmus.controllers.low_level_pid.interface import INTERFACE as LOW_LEVEL

_DESIGN = (
    *("mass", "yaw_inertia", "l_f", "l_r", "cornering_front", "cornering_rear"),
    *("pneumatic_trail", "relaxation_length"),
)
ACTUATOR = ("filter.speed", "filter.yaw_rate", "filter.steering", "steering.filter_time", "sample_period")
"""Parameters of LowLevelPid that delay a command; here they are assumed, as `actuator.*`."""
_SLOWEST_FILTER = 15.0  # rad/s: 3/omega is then all that the feed-forward can see ahead (leads.py)
_FASTEST_FILTER = 1e6  # rad/s: in effect no filter


def _actuator() -> list[Variable]:
    theirs = {variable.name: variable for variable in LOW_LEVEL.select("parameter")}
    return [_assumed(theirs[name]) for name in ACTUATOR]


def _assumed(theirs: Variable) -> Variable:
    """A parameter of the low-level controller as this one assumes it, with the same start."""
    bounds = (_SLOWEST_FILTER, _FASTEST_FILTER) if theirs.unit == "rad/s" else (0.0, theirs.maximum)
    return parameter(
        f"actuator.{theirs.name}",
        theirs.unit,
        f"assumed of the low-level controller: {theirs.description}",
        theirs.start,
        minimum=bounds[0],
        maximum=bounds[1],
        source=f"start value of LowLevelPid, {theirs.name}",
    )


def _estimate() -> list[Variable]:
    return [
        *group(input_, "estimate.position", "xy", "m", "world position of O1"),
        input_("estimate.yaw", "rad", "yaw angle"),
        *group(input_, "estimate.velocity", "xy", "m/s", "velocity of O1 in body axes"),
    ]


def _outputs() -> list[Variable]:
    return [
        output("command.acceleration", "m/s2", "longitudinal acceleration"),
        output("command.speed", "m/s", "forward speed"),
        output("command.yaw_rate", "rad/s", "yaw rate"),
        output(
            "command.steer_feedforward", "rad", "steering angle that gives the reference on the linear single-track"
        ),
        output("error.longitudinal", "m", "position error along the path, positive ahead"),
        output("error.lateral", "m", "position error across the path, positive to the left"),
        output("error.speed", "m/s", "speed minus reference speed"),
        output("error.course", "rad", "course minus reference course"),
        output("error.yaw", "rad", "yaw angle minus reference yaw angle"),
        output("feedback.acceleration", "m/s2", "part of the commanded acceleration given by the feedback"),
        output("feedback.yaw_rate", "rad/s", "part of the commanded yaw rate given by the feedback"),
        output("feedforward.sideslip", "rad", "reference sideslip angle of the linear single-track"),
        output("feedforward.yaw_rate", "rad/s", "reference yaw rate of the linear single-track"),
    ]


INTERFACE = sampled(
    "HighLevelLqr",
    "Trajectory tracking: finite-horizon LTV linear quadratic feedback and feed-forward by stable inversion",
    step=0.020,
    variables=[
        *load_parameters(Path(__file__).with_name("parameters.toml")),
        *_actuator(),
        *design_parameters(_DESIGN),
        *trajectory_bus(input_),
        *_estimate(),
        *_outputs(),
    ],
)
