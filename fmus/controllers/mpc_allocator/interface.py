"""What MpcAllocator shows."""

from __future__ import annotations

from pathlib import Path

from fmukit.interface import Variable, group, input_, load_parameters, output, parameter, sampled
from fmus.cars import published
from fmus.cars.wheels import WHEELS, motor_available
from fmus.controllers.bus import trajectory_bus
from fmus.double_track.interface import INTERFACE as PLANT

_HERE = Path(__file__).parent
_ACTUATOR = {
    "steer_lag": "steering.lag",
    "steer_rate": "steering.rate_limit",
    "steer_limit": "steering.limit",
    "slip_stiffness": "tyre.slip_stiffness",
}
"""Parameters `actuator.*` and the parameters of DoubleTrack that they assume."""


def _assumed(name: str, theirs: Variable) -> Variable:
    return parameter(
        name,
        theirs.unit,
        f"assumed of the car: {theirs.description}",
        theirs.start,
        minimum=theirs.minimum,
        maximum=theirs.maximum,
        source=f"start value of DoubleTrack, {theirs.name}",
    )


def _design() -> list[Variable]:
    return [_assumed(f"design.{v.name}", v) for v in published.double_track_parameters()]


def _actuator() -> list[Variable]:
    theirs = {variable.name: variable for variable in PLANT.select("parameter")}
    return [_assumed(f"actuator.{ours}", theirs[name]) for ours, name in _ACTUATOR.items()]


_INPUTS: list[Variable] = [
    *trajectory_bus(input_),
    *group(input_, "estimate.position", "xy", "m", "world position of O1"),
    input_("estimate.yaw", "rad", "yaw angle"),
    *group(input_, "estimate.velocity", "xy", "m/s", "velocity of O1 in body axes"),
    input_("estimate.yaw_rate", "rad/s", "yaw rate"),
    *group(input_, "wheel_speed", WHEELS, "rad/s", "measured wheel spin, positive forward"),
    *motor_available("1 while the motor works, 0 when it is known to be lost, between them a part of its force"),
]

_OUTPUTS: list[Variable] = [
    *group(output, "wheel_torque", WHEELS, "N.m", "motor torque on the wheel, positive drives"),
    output("command.steer_angle", "rad", "steering angle, positive left"),
    output("error.longitudinal", "m", "position error along the path, positive ahead"),
    output("error.lateral", "m", "position error across the path, positive to the left"),
    output("error.speed", "m/s", "speed minus reference speed"),
    output("error.course", "rad", "course minus reference course"),
    output("demand.force_x", "N", "force of the wheels that the prediction asks for"),
    output("demand.moment_z", "N.m", "yaw moment of the wheel forces that the prediction asks for"),
    output("residual.force_x", "N", "longitudinal force given by the wheels minus wanted"),
    output("residual.force_y", "N", "lateral force given by the wheels minus wanted"),
    output("residual.moment_z", "N.m", "yaw moment given by the wheels minus wanted"),
    output("disturbance.longitudinal", "m/s", "velocity along the path that the model does not explain"),
    output("disturbance.lateral", "m/s", "velocity across the path that the model does not explain"),
    output("disturbance.speed", "m/s2", "change of speed that the model does not explain"),
    output("disturbance.sideslip", "rad/s", "change of sideslip that the model does not explain"),
    output("disturbance.yaw", "rad/s", "change of yaw angle that the yaw rate does not explain"),
    output("disturbance.yaw_rate", "rad/s2", "yaw acceleration that the model does not explain"),
    *group(output, "motor_response", WHEELS, "1", "force of the wheel by its slip over the force asked for"),
    *group(output, "motor_lost", WHEELS, "1", "1 once the motor is known or found to be lost, else 0"),
    output("friction.counted", "1", "friction of the road that is counted on, as a part of that of the parameters"),
    output("friction.slow", "1", "1 while the path is followed without its times for want of friction, else 0"),
    output("solver.status", "1", "prediction: 1 solved, other values of OSQP; 0: inputs unusable, nothing was solved"),
    output("solver.iterations", "1", "prediction: iterations"),
    output("solver.time", "s", "prediction: time of the solver, 0 unless solver.timed"),
    output("allocation.status", "1", "distribution to the wheels: 1 solved, other values of OSQP"),
    output("allocation.iterations", "1", "distribution to the wheels: iterations"),
    output("allocation.time", "s", "distribution to the wheels: time of the solver, 0 unless solver.timed"),
    output("fallback.active", "1", "1 while an earlier plan is followed or the car brakes, else 0"),
    output("fallback.count", "1", "samples so far with fallback.active"),
    output("estimate.age", "s", "time since the estimate last changed while the car moved"),
    output("trajectory.age", "s", "time since the reference last moved"),
    output("trajectory.delay", "s", "time by which the reference waits for the car, see trajectory.gap"),
]

INTERFACE = sampled(
    "MpcAllocator",
    "Integral model predictive control about the trajectory bus, forces distributed to four driven wheels",
    step=0.020,
    periods=(0.005, 0.1),
    variables=[
        *load_parameters(_HERE / "parameters.toml"),
        *_actuator(),
        *_design(),
        *_INPUTS,
        *_OUTPUTS,
    ],
)
