"""MpcAllocator: a lane change driven beside the reference, without a car to answer, and a lost motor."""

from __future__ import annotations

from fmukit.reference_run import ReferenceRun
from fmus.cars.wheels import WHEELS
from fmus.controllers.high_level_lqr.reference_run import car_beside

_LOST, _RADIUS = 2.0, 0.302


def _inputs(t: float) -> dict[str, float]:
    """The trajectory bus, a car 0.2 m to the left with its yaw rate, and a motor lost, at time t [s]."""
    bus = car_beside(t)
    rolling = {f"wheel_speed.{wheel}": bus["estimate.velocity.x"] / _RADIUS for wheel in WHEELS}
    return bus | rolling | {"estimate.yaw_rate": bus["reference.yaw_rate"], "motor_available.rr": float(t < _LOST)}


RUN = ReferenceRun(
    "The reference is a lane change to the left at 25 m/s. The car is told to drive 0.2 m beside it without sideslip"
    " and does not answer; after 2 s the right rear motor is lost and its neighbours take over.",
    stop=4.0,
    step=0.02,
    inputs=_inputs,
    plots={
        "Error across the path": ("error.lateral",),
        "Steering angle": ("command.steer_angle",),
        "Wheel torques": tuple(f"wheel_torque.{wheel}" for wheel in WHEELS),
        "Disturbance, change of sideslip and yaw": ("disturbance.sideslip", "disturbance.yaw"),
        "Iterations": ("solver.iterations", "allocation.iterations"),
    },
)
