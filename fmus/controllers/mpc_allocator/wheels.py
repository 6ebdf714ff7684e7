"""From the force of both sides to the four wheels: the program of distribution.py and what is made of its solution."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Signals, block, slots
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import design_car
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U
from fmus.double_track import distribution


@block(p=slots(INTERFACE, "parameter"), u=N_U, delta=1, previous=4, reach=(4, 2))
def program(p: Signals, u: ca.SX, delta: ca.SX, previous: ca.SX, reach: ca.SX) -> tuple[ca.SX, ...]:
    """P_nz, q, A_nz, l, u of the program for the forces u of both sides at the steering angle delta.

    previous  forces of the wheels before [N]
    reach     lowest and highest force of each wheel now [N]
    """
    low, high = ca.horzsplit(reach)
    G, weights = distribution.effectiveness(design_car(p), delta), distribution.weights_of(p)
    y = wanted(p, u, delta)
    found = distribution.problem(G, 0, y, previous=previous, low=low, high=high, weights=weights)
    return tuple(ca.densify(ca.SX(value)) for value in found)


@block(p=slots(INTERFACE, "parameter"), u=N_U, delta=1, solution=4, solved=1, reach=(4, 2))
def result(p: Signals, u: ca.SX, delta: ca.SX, solution: ca.SX, solved: ca.SX, reach: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Forces (4) [N] within reach and what they miss (3), from the solution [kN], which counts if it is `solved`.

    Without a solution each side is shared equally.
    """
    equal = 0.5 * ca.vertcat(u[1], u[2], u[1], u[2])
    U = ca.if_else(solved, distribution.N * solution, equal)
    U = clip(U, reach[:, 0], reach[:, 1])
    G = distribution.effectiveness(design_car(p), delta)
    return U, distribution.residual(G, 0, wanted(p, u, delta), U)


def wanted(p: Signals, u: ca.SX, delta: ca.SX) -> ca.SX:
    """(F_x, F_y, M_z) (3) [N, N, N.m] of the wheel forces, as the prediction has them."""
    F_x = u[1] + u[2]
    return ca.vertcat(F_x, 0.5 * ca.sin(delta) * F_x, design_car(p).d * (u[2] - u[1]))
