"""The components, and nothing else. `CATALOGUE` is the one list of all FMUs; build, checks, docs and tests use it."""

from fmukit.component import Component
from fmus import double_track, estimator, unicycle, vehicle16dof
from fmus.controllers import (
    adaptive_follower,
    constraint_follower,
    high_level_lqr,
    low_level_pid,
    mpc_allocator,
    reference,
)
from fmus.planner import receding
from fmus.sensors import gps, imu, radio

CATALOGUE: tuple[Component, ...] = (
    vehicle16dof.COMPONENT,
    imu.COMPONENT,
    gps.COMPONENT,
    estimator.COMPONENT,
    reference.COMPONENT,
    high_level_lqr.COMPONENT,
    low_level_pid.COMPONENT,
    double_track.COMPONENT,
    mpc_allocator.COMPONENT,
    receding.COMPONENT,
    radio.COMPONENT,
    unicycle.COMPONENT,
    adaptive_follower.COMPONENT,
    constraint_follower.COMPONENT,
)
