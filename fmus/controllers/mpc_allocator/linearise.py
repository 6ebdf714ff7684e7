"""The prediction: errors about the reference over one node, in the frame of the path.

e = (e_s, e_n, e_v, e_beta, e_psi, e_omega, e_delta), w = u - u_r, both about the nodes of the reference:

    e_{k+1} = Phi_k e_k + Gamma_k w_k + c_k

A, B are the Jacobians of the car halfway between two nodes, turned with the path. c makes the prediction exact for the
car that is beside the reference by (e*, w*), the steady state under the disturbance d (rates of e, none of the
steering): it holds d, and what the reference lacks to be a motion of the car.
"""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from fmukit.kernel import Signals, block, slots
from fmus.cars.double_track import DoubleTrackCar
from fmus.clip import clip
from fmus.controllers.mpc_allocator import inversion
from fmus.controllers.mpc_allocator.design_car import INPUTS, SLOWEST, advance, design_car, rate
from fmus.controllers.mpc_allocator.discretise import zero_order_hold
from fmus.controllers.mpc_allocator.horizon import NODE, PERIOD
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.single_track.forces import STATES

N_X, N_U = len(STATES), len(INPUTS)
_LARGEST = ca.DM([0.2, 0.2, 1e4])  # rad, rad, N: of steady sideslip, steering angle and force of a side
_ROUNDS = 3
CarRate = Callable[[ca.SX, ca.SX], ca.SX]
"""(e, w) -> x' (7)."""


@block(p=slots(INTERFACE, "parameter"), node=len(NODE), after=len(NODE), d=N_X - 1)
def predicted(p: Signals, node: ca.SX, after: ca.SX, d: ca.SX) -> tuple[ca.SX, ...]:
    """Phi (7 x 7), Gamma (7 x 3), c (7), u_r (3), steady errors (7), steady w (3) from a node to the next, `after`."""
    car, lag = design_car(p), p["actuator.steer_lag"]
    u_r = reference_input(car, lag, node, after)
    A, B = jacobians(car, lag, node, after, u_r)
    Phi, held = zero_order_hold(A, PERIOD)
    Gamma = held @ B
    middle = 0.5 * (node + after)

    def f(e: ca.SX, w: ca.SX) -> ca.SX:
        return rate(car, lag, state(middle) + e, u_r + w, loading(middle))

    e, w = target(f, A, B, node[3], d)
    c = passing(car, lag, (node, after), u_r + w, e, d) - Phi @ e - Gamma @ w
    c[6] = 0  # known exactly
    return tuple(ca.cse([Phi, Gamma, ca.densify(c), u_r, e, w]))


def state(node: ca.SX) -> ca.SX:
    """The state (7) of the car on the node, seen from the node: at the origin, course 0."""
    v, beta, omega_z, delta = node[3], node[6], node[7], node[8]
    return ca.vertcat(0, 0, v, beta, -beta, omega_z, delta)


def loading(node: ca.SX) -> ca.SX:
    """Accelerations (a_x, a_y) [m/s2] behind the wheel loads on the node."""
    return ca.vertcat(node[4], node[3] ** 2 * node[5])


def reference_input(car: DoubleTrackCar, lag: ca.SX, node: ca.SX, after: ca.SX) -> ca.SX:
    """u_r (3): the command that takes the lagging steering angle from node to node, and equal forces of both sides."""
    delta_c = node[8] + (after[8] - node[8]) / (1 - ca.exp(-PERIOD / lag))
    F_x = sum(inversion.drive(car, lag, state(n), n[3:6]) for n in (node, after)) / 2
    return ca.vertcat(delta_c, F_x / 2, F_x / 2)


def jacobians(car: DoubleTrackCar, lag: ca.SX, node: ca.SX, after: ca.SX, u_r: ca.SX) -> tuple[ca.SX, ca.SX]:
    """A (7 x 7), B (7 x 3) halfway between the nodes; the frame turns with the course."""
    x, u = ca.SX.sym("x", N_X), ca.SX.sym("u", N_U)
    middle = 0.5 * (node + after)
    f = rate(car, lag, x, u, loading(middle))
    at = ca.substitute([ca.jacobian(f, x), ca.jacobian(f, u)], [x, u], [state(middle), u_r])
    A, B = at
    turning = (after[2] - node[2]) / PERIOD
    A[0, 1] += turning
    A[1, 0] -= turning
    return A, B


def passing(car: DoubleTrackCar, lag: ca.SX, nodes: tuple[ca.SX, ca.SX], inputs: ca.SX, e: ca.SX, d: ca.SX) -> ca.SX:
    """The errors (7) after one period of the car that starts with the errors e (e_s = e_n = 0), under d (6)."""
    node, after = nodes
    loads: dict[float, ca.SX] = {0: loading(node), 0.5: loading(0.5 * (node + after)), 1: loading(after)}
    unexplained = ca.vertcat(d, 0)
    start = state(node) + e
    found = advance(lambda x, part: rate(car, lag, x, inputs, loads[part]) + unexplained, start, inputs[0], lag, PERIOD)
    turn = after[2] - node[2]
    place = turned(after[:2] - node[:2], node[2])
    beside = found[2:] - state(after)[2:]
    beside[2] -= turn
    return ca.vertcat(turned(found[:2] - place, turn), beside)


def turned(vector: ca.SX, angle: ca.SX) -> ca.SX:
    """A vector (2) in axes turned by `angle` [rad]."""
    c, s = ca.cos(angle), ca.sin(angle)
    return ca.vertcat(c * vector[0] + s * vector[1], c * vector[1] - s * vector[0])


def target(f: CarRate, A: ca.SX, B: ca.SX, v: ca.SX, d: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Errors (7) and inputs (3) at rest under the disturbance d (6), with e_s = e_n = 0 and equal sides.

    e_v = -d_s, e_omega = -d_psi and e_psi = -d_n/v - e_beta; sideslip, steering angle and force solve the rows v',
    beta', omega_z' of f(e, w) + d = f(0, 0) by Newton's method with the Jacobians of the prediction.
    """
    rows = [2, 3, 5]
    unmoved = f(ca.SX.zeros(N_X), ca.SX.zeros(N_U))
    M = ca.horzcat(ca.densify(A[rows, [3, 6]]), ca.densify(B[rows, 1] + B[rows, 2]))
    y = ca.SX.zeros(3)
    for _ in range(_ROUNDS):
        y = clip(y - _solve3(M, (f(*_steady(y, v, d)) - unmoved)[rows] + d[rows]), -_LARGEST, _LARGEST)
    return _steady(y, v, d)


def _steady(y: ca.SX, v: ca.SX, d: ca.SX) -> tuple[ca.SX, ca.SX]:
    e_beta, e_delta, force = ca.vertsplit(y)
    e_psi = clip(-d[1] / ca.fmax(v, SLOWEST), -0.2, 0.2) - e_beta
    return ca.vertcat(0, 0, -d[0], e_beta, e_psi, -d[4], e_delta), ca.vertcat(e_delta, force, force)


def _solve3(M: ca.SX, b: ca.SX) -> ca.SX:
    """M^-1 b by Cramer's rule."""
    det = ca.det(M)
    solved = []
    for k in range(3):
        replaced = ca.SX(M)
        replaced[:, k] = b
        solved.append(ca.det(replaced) / det)
    return ca.vertcat(*solved)
