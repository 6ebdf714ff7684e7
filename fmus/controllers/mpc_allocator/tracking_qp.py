"""The quadratic program of the prediction: its fixed pattern and the numbers of one sample.

Unknown are, node after node, w_k (3), e_{k+1} (7) and the signed excess sigma_{k+1} of the lateral error over its
corridor; all scaled to order one. With the steady values (e*, w*) of the disturbance and the weights Q, R, S, rho

    minimise  sum_k (e_k - e*_k)' Q (e_k - e*_k) + (w_k - w*_k)' R (w_k - w*_k) + (w_k - w_{k-1})' S (w_k - w_{k-1})
              + rho sigma_k^2,     Q times the terminal factor at the last node
    subject to  e_{k+1} = Phi_k e_k + Gamma_k w_k + c_k
                low_k <= u_r,k + w_k <= high_k
                -step <= (u_r,k + w_k) - (u_r,k-1 + w_{k-1}) <= step
                -half width <= e_n,k - sigma_k <= half width

The first node's rate is in low_0, high_0. Holding u within its bounds is always feasible, whatever the state.
"""

from __future__ import annotations

from itertools import accumulate

import casadi as ca

from fmukit.kernel import Block, Parts, block
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.linearise import N_U, N_X

UNIT_E = ca.DM([1.0, 0.15, 1.0, 0.04, 0.04, 0.3, 0.1])
UNIT_W = ca.DM([0.05, 1.5e3, 1.5e3])
UNIT_S = 0.3
"""Sizes of errors, inputs and excess that are 1 in the program."""
_BLOCK = N_U + N_X + 1
SIZE, ROWS = NODES * _BLOCK, NODES * (N_X + N_U + 1) + (NODES - 1) * N_U


def program(Phi: ca.Sparsity, Gamma: ca.Sparsity) -> Block:
    """The program for matrices Phi (7 x 7) and Gamma (7 x 3) of these patterns.

    Its arguments are, side by side for all nodes where a node has its own: Phi, Gamma, c, u_r, e*, w*; e now, w before;
    low and high at the first node and after it (3 x 2 each); step (3); weights (of e 7, terminal factor, of w 3, of its
    change 3, of the excess, half width of the corridor). It gives (P, q, A, l, u), of P the upper triangle.
    """

    @block(
        Phi=ca.repmat(Phi, 1, NODES),
        Gamma=ca.repmat(Gamma, 1, NODES),
        c=(N_X, NODES),
        u_r=(N_U, NODES),
        e_steady=(N_X, NODES),
        w_steady=(N_U, NODES),
        e=N_X,
        w=N_U,
        first=(N_U, 2),
        bounds=(N_U, 2),
        step=N_U,
        weights=N_X + 1 + 2 * N_U + 2,
    )
    def numbers(**data: ca.SX) -> tuple[ca.SX, ca.SX, ca.SX, ca.SX, ca.SX]:
        P, q = _cost(data)
        A, low, high = _rows(data)
        return P, ca.densify(q), A, ca.densify(low), ca.densify(high)

    return numbers


def inputs(solution: ca.MX, u_r: ca.MX) -> ca.MX:
    """u (3 x NODES) of the solution."""
    return u_r + UNIT_W * ca.reshape(solution, _BLOCK, NODES)[:N_U, :]


def moved_on(solution: ca.MX) -> ca.MX:
    """The solution of one node later, to start from; the last node is repeated."""
    return ca.vertcat(solution[_BLOCK:], solution[-_BLOCK:])


def multipliers_moved_on(multipliers: ca.MX) -> ca.MX:
    """The multipliers of one node later."""
    per_node = N_X + N_U + 1
    nodes, rates = multipliers[: NODES * per_node], multipliers[NODES * per_node :]
    return ca.vertcat(nodes[per_node:], nodes[-per_node:], rates[N_U:], rates[-N_U:])


def _cost(data: Parts) -> tuple[ca.SX, ca.SX]:
    """Upper triangle of P and q; 1/2 z'Pz + q'z is half the sum above, but for a constant."""
    Q, terminal, R, S, rho = ca.vertsplit(data["weights"][:-1], list(accumulate((0, N_X, 1, N_U, N_U, 1))))
    Q, R, S = Q * UNIT_E**2, R * UNIT_W**2, S * UNIT_W**2
    P, q = ca.SX(SIZE, SIZE), list[ca.SX]()
    for k in range(NODES):
        start, last = k * _BLOCK, k == NODES - 1
        at_end = terminal if last else 1
        diagonal = ca.vertcat(R + S * (1 if last else 2), Q * at_end, rho * UNIT_S**2)
        for i in range(_BLOCK):
            P[start + i, start + i] = diagonal[i]
        if not last:
            for i in range(N_U):
                P[start + i, start + _BLOCK + i] = -S[i]
        w_pull = R * data["w_steady"][:, k] / UNIT_W + (S * data["w"] / UNIT_W if k == 0 else 0)
        q += [-w_pull, -Q * at_end * data["e_steady"][:, k] / UNIT_E, ca.SX(0)]
    return P, ca.vertcat(*q)


def _rows(data: Parts) -> tuple[ca.SX, ca.SX, ca.SX]:
    """A, l, u: per node the prediction, the inputs, the corridor; then the rates."""
    half_width = data["weights"][-1]
    Phi, Gamma = ca.horzsplit(data["Phi"], N_X), ca.horzsplit(data["Gamma"], N_U)
    A, row = ca.SX(ROWS, SIZE), 0
    low, high = list[ca.SX](), list[ca.SX]()
    for k in range(NODES):
        start = k * _BLOCK
        before = start - _BLOCK + N_U
        A[row : row + N_X, start : start + N_U] = ca.diag(1 / UNIT_E) @ Gamma[k] @ ca.diag(UNIT_W)
        A[row : row + N_X, start + N_U : start + N_U + N_X] = -ca.SX.eye(N_X)
        carried = Phi[k] @ data["e"] if k == 0 else ca.SX.zeros(N_X)
        if k:
            A[row : row + N_X, before : before + N_X] = ca.diag(1 / UNIT_E) @ Phi[k] @ ca.diag(UNIT_E)
        constant = -(data["c"][:, k] + carried) / UNIT_E
        limits = data["bounds"] if k else data["first"]
        w_low, w_high = ((limits[:, j] - data["u_r"][:, k]) / UNIT_W for j in range(2))
        A[row + N_X : row + N_X + N_U, start : start + N_U] = ca.SX.eye(N_U)
        A[row + N_X + N_U, start + N_U + 1] = 1
        A[row + N_X + N_U, start + N_U + N_X] = -UNIT_S / UNIT_E[1]
        low += [constant, w_low, -half_width / UNIT_E[1]]
        high += [constant, w_high, half_width / UNIT_E[1]]
        row += N_X + N_U + 1
    for k in range(1, NODES):
        A[row : row + N_U, k * _BLOCK : k * _BLOCK + N_U] = ca.SX.eye(N_U)
        A[row : row + N_U, (k - 1) * _BLOCK : (k - 1) * _BLOCK + N_U] = -ca.SX.eye(N_U)
        moved = data["u_r"][:, k] - data["u_r"][:, k - 1]
        low.append((-data["step"] - moved) / UNIT_W)
        high.append((data["step"] - moved) / UNIT_W)
        row += N_U
    return A, ca.vertcat(*low), ca.vertcat(*high)
