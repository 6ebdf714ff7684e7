"""What MpcAllocator keeps from sample to sample."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts
from fmus.controllers.bus import SAMPLE
from fmus.controllers.mpc_allocator import detection, grip, memory, plan, tracking_qp
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.linearise import N_U, N_X

STATES = Layout(
    started=1,  # 0 before the first sample with usable inputs
    bus=len(SAMPLE),  # sample of the bus when it moved last
    age=1,  # s since then
    past=memory.ROW * memory.PAST,
    lost=1,  # 1 while the bus is too far ahead of the car for the memory
    delay=1,  # s by which the car is behind the reference's times
    pace=1,  # at which the reference is gone through
    errors=N_X,  # at the sample before
    path_speed=1,  # speed of the reference then, in its own times [m/s]
    zero_dynamics=2,  # sideslip and yaw rate of the car on the reference
    car=N_X,  # estimated state of the car at the sample before
    known=1,  # 1 when that can be learnt from
    estimate=6,  # inputs when they last changed
    estimate_age=1,  # s since then
    forces=4,  # of the wheels since then [N]
    command=1,  # steering angle asked for since then [rad]
    acceleration=2,  # of the body then, behind the wheel loads [m/s2]
    disturbance=N_X - 1,
    beside=N_U,  # inputs applied then less those of the reference
    motors=4,  # motors available then, as told
    detection=detection.STATES,
    grip=grip.STATES,
    slow=1,  # 1 while the path is followed without its times for want of friction
    path_acceleration=1,  # of the reference at the sample before, in its own times [m/s2]
    plan=N_U * NODES,  # inputs planned
    alone=1,  # s since a plan was found
    fallbacks=1,
    solution=tracking_qp.SIZE,
    multipliers=tracking_qp.ROWS,
    penalty=1,
    wheel_multipliers=4,
    wheel_penalty=1,
)


def start() -> Parts:
    """The states before the first sample, but for zeros: no plan to follow, all motors working."""
    return {"alone": plan.LENGTH, "motors": ca.DM.ones(4), "pace": 1.0, "grip": {"friction": 1.0, "variance": 0.0}}
