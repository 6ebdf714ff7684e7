"""The quadratic program of the prediction: another solver, the Riccati recursion, and that it always has a solution."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import casadi as ca
import daqp
import numpy as np
import pytest
from scipy.linalg import block_diag

from fmukit.qp import QpSettings, qp_solver
from fmus.controllers.mpc_allocator import programs, tracking_qp
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U, N_X, predicted

Array = np.ndarray
_START = {variable.name: float(variable.start) for variable in INTERFACE.select("parameter")}
_SIZES = np.array([0.05, 0.3, 0.5, 0.02, 0.05, 0.1, 0.02])
_FREE = 1e6


class Data(NamedTuple):
    """The arguments of the program, in order."""

    Phi: Array
    Gamma: Array
    c: Array
    u_r: Array
    e_steady: Array
    w_steady: Array
    e: Array
    w: Array
    first: Array
    bounds: Array
    step: Array
    weights: Array


def _weights(corridor: float) -> Array:
    values = [_START[name] for name in programs.WEIGHTS]
    return np.array([*values[:-2], corridor, values[-1]])


def _box(size: Array) -> Array:
    return np.column_stack([-size, size])


def _data(seed: int, limit: Array, corridor: float = 1000.0, steady: float = 1.0) -> Data:
    """A program about a car at 20 m/s that winds a little, with random errors and steady states."""
    draw = np.random.default_rng(seed)
    p = [_START[name] for name in INTERFACE.names("parameter")]
    Phi, Gamma, u_r = [], [], []
    for k in range(NODES):
        kappa = 0.01 * np.sin(0.3 * k + seed)
        node = np.array([0.4 * k, 0, 0, 20, 0.5, kappa, -0.5 * kappa, 20 * kappa, 3 * kappa])
        after = np.add(node, [0.4, 0, 0.4 * kappa, 0.01, 0, 0, 0, 0, 0])
        found = predicted(p, node, after, np.zeros(6))
        Phi.append(found[0].full())
        Gamma.append(found[1].full())
        u_r.append(found[3].full())
    e_steady = steady * 0.1 * draw.normal(size=(N_X, NODES)) * _SIZES[:, None]
    w_steady = steady * 0.1 * draw.normal(size=(N_U, NODES)) * [[0.05], [1e3], [1e3]]
    c = steady * 0.02 * draw.normal(size=(N_X, NODES)) * _SIZES[:, None]
    box = _box(limit)
    return Data(
        np.hstack(Phi),
        np.hstack(Gamma),
        c,
        np.hstack(u_r),
        e_steady,
        w_steady,
        _SIZES * draw.normal(size=N_X),
        np.zeros(N_U),
        box,
        box,
        limit,
        _weights(corridor),
    )


def _numbers(data: Data) -> tuple[Array, Array, Array, Array, Array]:
    """P, q, A, l, u in full."""
    upper, q, A, low, high = (part.full() for part in programs.program()(*_sparse(data)))
    return upper + upper.T - np.diag(np.diag(upper)), q.ravel(), A, low.ravel(), high.ravel()


def _nonzeros(data: Data) -> tuple[ca.DM, ...]:
    """P, q, A, l, u as a solver takes them."""
    P, q, A, low, high = programs.program()(*_sparse(data))
    return P.nz[:], q, A.nz[:], low, high


def _sparse(data: Data) -> list[Array | ca.DM]:
    """The matrices on their patterns."""
    pattern = programs.program().function
    return [ca.project(ca.DM(data[i]), pattern.sparsity_in(i)) for i in range(2)] + list(data[2:])


def _solve(data: Data, solver: ca.Function) -> tuple[Array, int]:
    """The inputs w (3 x NODES) and the status."""
    start = [np.zeros(tracking_qp.SIZE), np.zeros(tracking_qp.ROWS), 0, 0]
    found = solver(*_nonzeros(data), *start)
    nothing = ca.DM.zeros(N_U, NODES)
    w = tracking_qp.inputs(ca.MX(found[0]), ca.MX(nothing))
    return ca.evalf(w).full(), int(found[3])


@cache
def _exact() -> ca.Function:
    settings = QpSettings(absolute=1e-9, relative=1e-9, iterations=20000, check=20, adapt=40)
    pattern = programs.program().function.sparsity_out
    return qp_solver("tracking_exact", pattern(0), pattern(2), settings).function


_TIGHT, _WIDE = np.array([0.03, 1500.0, 1500.0]), np.array([_FREE] * 3)


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_solution_is_that_of_another_method(seed: int) -> None:
    """DAQP, an active set method, on the same numbers; the solver in the FMU stops at its own, looser tolerance."""
    data = _data(seed, _TIGHT)
    P, q, A, low, high = _numbers(data)
    sense = np.where(high - low < 1e-12, 5, 0).astype(np.int32)
    best, _, flag, _ = daqp.solve(P, q, np.ascontiguousarray(A), high, low, sense)
    assert flag == 1
    theirs = best.reshape(NODES, -1)[:, :N_U].T * np.array(tracking_qp.UNIT_W).ravel()[:, None]
    exact, status = _solve(data, _exact())
    assert status == 1
    assert exact / _TIGHT[:, None] == pytest.approx(theirs / _TIGHT[:, None], abs=1e-4)
    assert np.any(np.abs(np.abs(exact + data.u_r) - _TIGHT[:, None]) < 1e-6)  # some limits are reached
    used, status = _solve(data, programs.solvers()[0].function)
    assert status == 1
    assert used[:, 0] / _TIGHT == pytest.approx(theirs[:, 0] / _TIGHT, abs=0.02)


@pytest.mark.parametrize("seed", [4, 5])
def test_without_limits_the_first_input_is_the_riccati_feedback(seed: int) -> None:
    data = _data(seed, _WIDE, corridor=0.0, steady=0.0)
    w, status = _solve(data, _exact())
    assert status == 1
    K = _riccati(data)
    size = np.array([0.1, 2e3, 2e3])
    assert w[:, 0] / size == pytest.approx(-(K @ np.concatenate([data.e, data.w])) / size, abs=1e-4)


def _riccati(data: Data) -> Array:
    """The gain of the first node on (e, w before), backwards from the terminal weight; the input is the change of w."""
    Q, terminal = np.diag(data.weights[:N_X]), data.weights[N_X]
    R, S = (np.diag(data.weights[N_X + 1 + i * N_U :][:N_U]) for i in range(2))
    cost, gain = block_diag(terminal * Q, np.zeros((N_U, N_U))), np.zeros((N_U, N_X + N_U))
    for k in reversed(range(NODES)):
        Phi, Gamma = data.Phi[:, k * N_X : (k + 1) * N_X], data.Gamma[:, k * N_U : (k + 1) * N_U]
        A = np.block([[Phi, np.zeros((N_X, N_U))], [np.zeros((N_U, N_X + N_U))]])
        B = np.vstack([Gamma, np.eye(N_U)])
        here = block_diag(Q if k else np.zeros((N_X, N_X)), S)
        cross = np.vstack([np.zeros((N_X, N_U)), -S])
        H = R + S + B.T @ cost @ B
        gain = np.linalg.solve(H, B.T @ cost @ A + cross.T)
        cost = here + A.T @ cost @ A - gain.T @ H @ gain
    return gain


@pytest.mark.parametrize("size", [1.0, 10.0, 100.0])
def test_holding_the_inputs_is_feasible_whatever_the_state(size: float) -> None:
    data = _data(6, _TIGHT)
    data = data._replace(e=size * data.e, first=_box(0.5 * _TIGHT), step=0.1 * _TIGHT)
    _, _, A, low, high = _numbers(data)
    hold = np.array([0.01, 500.0, -500.0])
    z, e = np.zeros(tracking_qp.SIZE), data.e
    blocks = z.reshape(NODES, -1)
    units = np.concatenate([np.array(unit).ravel() for unit in (tracking_qp.UNIT_W, tracking_qp.UNIT_E)])
    for k in range(NODES):
        w = hold - data.u_r[:, k]
        e = data.Phi[:, k * N_X : (k + 1) * N_X] @ e + data.Gamma[:, k * N_U : (k + 1) * N_U] @ w + data.c[:, k]
        blocks[k, : N_U + N_X] = np.concatenate([w, e]) / units
        blocks[k, -1] = e[1] / tracking_qp.UNIT_S
    assert np.all(A @ z >= low - 1e-9)
    assert np.all(A @ z <= high + 1e-9)


def test_more_corridor_weight_means_less_excess() -> None:
    data = _data(7, _TIGHT, steady=0.0)._replace(e=np.array([0, 0.4, 0, 0, 0, 0, 0]))
    excess = []
    for weight in (0.0, 1e3, 1e5):
        numbers = _nonzeros(data._replace(weights=_weights(weight)))
        found = _exact()(*numbers, np.zeros(tracking_qp.SIZE), np.zeros(tracking_qp.ROWS), 0, 0)
        e_n = found[0].full().reshape(NODES, -1)[:, N_U + 1] * float(tracking_qp.UNIT_E[1])
        excess.append(np.sum(np.maximum(np.abs(e_n) - _START["corridor.half_width"], 0.0) ** 2))
    assert excess[0] > excess[1] > excess[2]
