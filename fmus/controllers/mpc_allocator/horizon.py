"""The reference on the nodes of the horizon: from the trajectory bus to states and inputs of the car."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import symbols
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


def reference(p: ca.MX, z: ca.MX, path: ca.MX) -> ca.MX:
    """The nodes (9 x NODES + 1) of the car that is at z on the path of half nodes."""
    begin, middle, end = path[:, :-1:2], path[:, 1::2], path[:, 2::2]
    numbers = ca.repmat(p, 1, NODES)
    later = _advance().mapaccum("zero_dynamics", NODES)(z, numbers, begin, middle, end, ca.DM.ones(1, NODES) * PERIOD)
    inner = ca.horzcat(z, later)
    steering = _steering().map(NODES + 1)(ca.repmat(p, 1, NODES + 1), inner, path[:, ::2])
    return ca.vertcat(path[:, ::2], inner, steering)


def later(p: ca.MX, z: ca.MX, path: ca.MX, ahead: ca.MX, Ts: ca.MX) -> ca.MX:
    """z one sampling period later."""
    return _advance()(z, p, path[:, 0], ahead[:, 0], ahead[:, 1], Ts)


def steady(p: ca.MX, path: ca.MX) -> ca.MX:
    """The equilibrium z at the first sample of the path."""
    parameters, s = symbols(INTERFACE, "parameter"), ca.SX.sym("s", len(SAMPLE))
    z = inversion.steady(design_car(parameters), s[3], s[5])
    return ca.Function("steady", [parameters.column, s], [z])(p, path[:, 0])


def _advance() -> ca.Function:
    parameters, z, h = symbols(INTERFACE, "parameter"), ca.SX.sym("z", 2), ca.SX.sym("h")
    s = [ca.SX.sym(name, len(SAMPLE)) for name in ("begin", "middle", "end")]
    begin, middle, end = (sample[3:] for sample in s)
    after = inversion.advance(design_car(parameters), z, (begin, middle, end), h)
    return ca.Function("advance", [z, parameters.column, *s, h], [ca.cse(after)])


def _steering() -> ca.Function:
    parameters, z, s = symbols(INTERFACE, "parameter"), ca.SX.sym("z", 2), ca.SX.sym("s", len(SAMPLE))
    delta = inversion.steering(design_car(parameters), z, s[3:])
    return ca.Function("steering", [parameters.column, z, s], [ca.cse(delta)])
