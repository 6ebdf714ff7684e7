"""The reference on the nodes of the horizon: from the trajectory bus to states and inputs of the car."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals, block, slots
from fmus.controllers.bus import SAMPLE
from fmus.controllers.mpc_allocator import inversion
from fmus.controllers.mpc_allocator.design_car import design_car
from fmus.controllers.mpc_allocator.interface import INTERFACE

NODES, PERIOD = 25, 0.02
NODE = (*SAMPLE, "beta", "omega_z", "delta")
"""A node of the reference: the sample of the path, then sideslip, yaw rate and steering angle of the car on it."""


def times(Ts: ca.MX) -> ca.MX:
    """Times ahead [s] of all half nodes (2 NODES + 1), then Ts/2 and Ts, at which the next sample begins."""
    grid = ca.DM([0.5 * PERIOD * k for k in range(2 * NODES + 1)])
    return ca.vertcat(grid, 0.5 * Ts, Ts)


def reference(p: Signals, z: ca.MX, path: ca.MX) -> ca.MX:
    """The nodes (9 x NODES + 1) of the car that is at z on the path of half nodes."""
    begin, middle, end = path[:, :-1:2], path[:, 1::2], path[:, 2::2]
    periods = ca.DM.ones(1, NODES) * PERIOD
    zero_dynamics = _advance.function.mapaccum("zero_dynamics", NODES)
    later = zero_dynamics(z, ca.repmat(p.column, 1, NODES), begin, middle, end, periods)
    inner = ca.horzcat(z, later)
    angles = _steering.function.map(NODES + 1)(ca.repmat(p.column, 1, NODES + 1), inner, path[:, ::2])
    return ca.vertcat(path[:, ::2], inner, angles)


def later(p: Signals, z: ca.MX, path: ca.MX, ahead: ca.MX, Ts: ca.MX) -> ca.MX:
    """z one sampling period later."""
    return _advance(z, p, path[:, 0], ahead[:, 0], ahead[:, 1], Ts)


@block(p=slots(INTERFACE, "parameter"), sample=len(SAMPLE))
def steady(p: Signals, sample: ca.SX) -> ca.SX:
    """The equilibrium z at a sample of the path."""
    return inversion.steady(design_car(p), sample[3], sample[5])


@block(z=2, p=slots(INTERFACE, "parameter"), begin=len(SAMPLE), middle=len(SAMPLE), end=len(SAMPLE), h=1)
def _advance(z: ca.SX, p: Signals, begin: ca.SX, middle: ca.SX, end: ca.SX, h: ca.SX) -> ca.SX:
    return ca.cse(inversion.advance(design_car(p), z, (begin[3:], middle[3:], end[3:]), h))


@block(p=slots(INTERFACE, "parameter"), z=2, sample=len(SAMPLE))
def _steering(p: Signals, z: ca.SX, sample: ca.SX) -> ca.SX:
    return ca.cse(inversion.steering(design_car(p), z, sample[3:]))
