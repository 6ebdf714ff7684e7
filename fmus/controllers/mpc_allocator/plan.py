"""The plan that is followed: the one just found, else the one before moved on, and when that has run out, braking."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals, block, slots
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import STANDSTILL, design_car
from fmus.controllers.mpc_allocator.horizon import NODES, PERIOD
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U

LENGTH = NODES * PERIOD
"""Time [s] for which a plan can be followed."""
_CREEP = 0.5  # m/s, below it braking fades with the speed, so that the car does not reverse


@block(p=slots(INTERFACE, "parameter"), found=(N_U, NODES), good=1, kept=(N_U, NODES), alone=1, command=1, v=1)
def follow(
    p: Signals, found: ca.SX, good: ca.SX, kept: ca.SX, alone: ca.SX, command: ca.SX, v: ca.SX
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Plan (3 x NODES) as of the present sample, u (3) wanted now, and time without a plan found [s].

    found    the plan just found, to be followed if it is `good`
    kept     the plan before
    alone    time without a plan found until the sample before [s]
    command  steering angle asked for then [rad]
    v        speed [m/s]: towards rest the steering follows the plan ever more slowly, and both sides get the same force
    """
    Ts = p["sample_period"]
    plan = ca.if_else(good, found, moved_on(kept, Ts))
    without = ca.if_else(good, 0, ca.fmin(alone + Ts, 1e3))
    brake = -0.5 * design_car(p).planar.m * p["fallback.deceleration"] * clip(v / _CREEP, -1, 1)
    wanted = ca.if_else(without < LENGTH, plan[:, 0], ca.vertcat(command, brake, brake))
    moving = clip(ca.fabs(v) / STANDSTILL, 0, 1)
    steer = command + moving * (wanted[0] - command)
    both, apart = 0.5 * (wanted[1] + wanted[2]), 0.5 * moving * (wanted[2] - wanted[1])
    return plan, ca.vertcat(steer, both - apart, both + apart), without


def moved_on(plan: ca.SX, Ts: ca.SX) -> ca.SX:
    """The plan one sampling period later, its last inputs held."""
    part = clip(Ts / PERIOD, 0, 1)
    later = ca.horzcat(plan[:, 1:], plan[:, -1])
    return plan + part * (later - plan)
