"""The plan that is followed: the one just found, else the one before moved on, and when that has run out, braking."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import symbols
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import STANDSTILL, design_car
from fmus.controllers.mpc_allocator.horizon import NODES, PERIOD
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U

LENGTH = NODES * PERIOD
"""Time [s] for which a plan can be followed."""
_CREEP = 0.5  # m/s, below it braking fades with the speed, so that the car does not reverse


def function() -> ca.Function:
    """(p, found (3 x NODES), good, plan before (3 x NODES), time alone [s], command before, v, Ts)
    -> plan (3 x NODES), u (3) wanted now, time alone.

    The plan is kept as of the present sample. Towards rest the steering follows the plan ever more slowly, and both
    sides get the same force.
    """
    p, found, kept = symbols(INTERFACE, "parameter"), ca.SX.sym("found", N_U, NODES), ca.SX.sym("kept", N_U, NODES)
    good, alone, command = ca.SX.sym("good"), ca.SX.sym("alone"), ca.SX.sym("command")
    v, Ts = ca.SX.sym("v"), ca.SX.sym("Ts")
    plan = ca.if_else(good, found, moved_on(kept, Ts))
    without = ca.if_else(good, 0, ca.fmin(alone + Ts, 1e3))
    brake = -0.5 * design_car(p).planar.m * p["fallback.deceleration"] * clip(v / _CREEP, -1, 1)
    wanted = ca.if_else(without < LENGTH, plan[:, 0], ca.vertcat(command, brake, brake))
    moving = clip(ca.fabs(v) / STANDSTILL, 0, 1)
    steer = command + moving * (wanted[0] - command)
    both, apart = 0.5 * (wanted[1] + wanted[2]), 0.5 * moving * (wanted[2] - wanted[1])
    arguments = [p.column, found, good, kept, alone, command, v, Ts]
    return ca.Function("follow", arguments, [plan, ca.vertcat(steer, both - apart, both + apart), without])


def moved_on(plan: ca.SX, Ts: ca.SX) -> ca.SX:
    """The plan one sampling period later, its last inputs held."""
    part = clip(Ts / PERIOD, 0, 1)
    later = ca.horzcat(plan[:, 1:], plan[:, -1])
    return plan + part * (later - plan)
