"""From the force of both sides to the four wheels: the program of distribution.py and what is made of its solution."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals, symbols
from fmus.controllers.mpc_allocator.design_car import design_car
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U
from fmus.double_track import distribution


def program() -> ca.Function:
    """(p, u (3), delta, forces before (4), low and high of the wheels (4 x 2)) -> P_nz, q, A_nz, l, u."""
    p, u, delta = symbols(INTERFACE, "parameter"), ca.SX.sym("u", N_U), ca.SX.sym("delta")
    U, reach = ca.SX.sym("U", 4), ca.SX.sym("reach", 4, 2)
    G = distribution.effectiveness(design_car(p), delta)
    found = distribution.problem(
        G, 0, wanted(p, u, delta), previous=U, low=reach[:, 0], high=reach[:, 1], weights=distribution.weights_of(p)
    )
    arguments = [p.column, u, delta, U, reach]
    return ca.Function("program", arguments, [ca.densify(ca.SX(value)) for value in found])


def result() -> ca.Function:
    """(p, u (3), delta, solution [kN], solved, low and high (4 x 2)) -> forces (4) [N] within reach, residual (3).

    Without a solution each side is shared equally.
    """
    p, u, delta = symbols(INTERFACE, "parameter"), ca.SX.sym("u", N_U), ca.SX.sym("delta")
    solution, solved, reach = ca.SX.sym("solution", 4), ca.SX.sym("solved"), ca.SX.sym("reach", 4, 2)
    equal = 0.5 * ca.vertcat(u[1], u[2], u[1], u[2])
    U = ca.if_else(solved, distribution.N * solution, equal)
    U = ca.fmin(ca.fmax(U, reach[:, 0]), reach[:, 1])
    G = distribution.effectiveness(design_car(p), delta)
    missed = distribution.residual(G, 0, wanted(p, u, delta), U)
    return ca.Function("result", [p.column, u, delta, solution, solved, reach], [U, missed])


def wanted(p: Signals, u: ca.SX, delta: ca.SX) -> ca.SX:
    """(F_x, F_y, M_z) (3) [N, N, N.m] of the wheel forces, as the prediction has them."""
    F_x = u[1] + u[2]
    return ca.vertcat(F_x, 0.5 * ca.sin(delta) * F_x, design_car(p).d * (u[2] - u[1]))
