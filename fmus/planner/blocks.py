"""The gaps between the intervals of a plan and their derivatives, put together block by block."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from fmus.planner.program import Symbols
from fmus.planner.shooting import derivatives, interval
from fmus.planner.vehicle import Vehicle

Index = NDArray[np.int64]
_CALL = {"never_inline": True}


@dataclass(frozen=True, slots=True)
class Shots:
    """`gaps` (n m,): each interval's end, in the next frame, less the next state; all scaled.

    `jacobian`: their derivative; `hessian` of a sum of them with `weights` (n m,), the upper triangle. Both are in
    all decision variables.
    """

    gaps: ca.MX
    jacobian: ca.MX
    hessian: ca.MX
    weights: ca.MX


def shots(vehicle: Vehicle, s: Symbols, steps: ca.MX | ca.DM, substeps: int, constants: ca.MX | None = None) -> Shots:
    """The gaps of all m intervals; `steps` (3, m) lead from each node's frame to the next, see `Gates.steps`.

    `constants` are given to the vehicle's f as its last argument.
    """
    n, m = s.X.shape[0], s.U.shape[1]
    f = _scaled(vehicle)
    exact = derivatives(f, substeps)
    turn = _turn(vehicle, exact.first.sparsity_out(0))
    arguments = s.X[:, :-1], s.U, ca.repmat(s.T, 1, m // s.T.numel())
    given = [] if constants is None else [ca.repmat(constants, 1, m)]
    mu = ca.MX.sym("mu", n * m)
    slopes = turn.slope.map(m)(exact.first.map(m)(*arguments, *given), steps)
    bends = exact.second.map(m)(*arguments, turn.weight.map(m)(ca.reshape(mu, n, m), steps), *given)
    columns, count = _columns(s), s.column.numel()
    ahead = ca.DM.triplet(range(n * m), range(n, n * (m + 1)), ca.DM.ones(n * m), n * m, count)
    rows = np.arange(n * m).reshape(m, n)
    return Shots(
        ca.vec(turn.end.map(m)(interval(f, substeps).map(m)(*arguments, *given), steps) - s.X[:, 1:]),
        _scattered(slopes, turn.slope.sparsity_out(0), rows, columns, (n * m, count)) - ahead,
        _scattered(bends, exact.second.sparsity_out(0), columns, columns, (count, count)),
        mu,
    )


def with_derivatives(nlp: dict[str, Any], s: Shots, rest: ca.MX | None = None) -> dict[str, ca.Function]:
    """Options `jac_g` and `hess_lag` of CasADi's solvers for a program whose constraints are the gaps and the `rest`.

    Give the rest: cut out of all constraints, CasADi may differentiate its way through the gaps again.
    """
    w, p, f, g = (nlp[name] for name in ("x", "p", "f", "g"))
    rest = g[s.gaps.numel() :] if rest is None else rest
    weight, weights = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", rest.numel())
    others = ca.triu(ca.hessian(weight * f + ca.dot(weights, rest), w)[0])
    jacobian = ca.vertcat(s.jacobian, ca.jacobian(rest, w))
    return {
        "jac_g": ca.Function("nlp_jac_g", [w, p], [g, jacobian], ["x", "p"], ["g", "jac_g_x"]),
        "hess_lag": ca.Function(
            "nlp_hess_l",
            [w, p, weight, ca.vertcat(s.weights, weights)],
            [s.hessian + others],
            ["x", "p", "lam_f", "lam_g"],
            ["triu_hess_gamma_x_x"],
        ),
    }


@dataclass(frozen=True, slots=True)
class _Turn:
    """Into the next frame: `end` (state, step), `slope` (its derivative, step), `weight` (of the result, step)."""

    end: ca.Function
    slope: ca.Function
    weight: ca.Function


def _turn(vehicle: Vehicle, pattern: ca.Sparsity) -> _Turn:
    """For scaled states; `pattern` is that of an interval's derivative."""
    n = len(vehicle.scale)
    x, step, slope, mu = ca.SX.sym("x", n), ca.SX.sym("step", 3), ca.SX.sym("slope", pattern), ca.SX.sym("mu", n)
    c, s = ca.cos(step[2]), ca.sin(step[2])
    rotation, scale = ca.SX.eye(n), ca.DM(vehicle.scale)
    rotation[:2, :2] = ca.vertcat(ca.horzcat(c, s), ca.horzcat(-s, c))
    turned = ca.diag(1 / scale) @ rotation @ ca.diag(scale)
    away = ca.vertcat(step[:2], ca.DM(2, 1), step[2], ca.DM(2, 1)) / scale
    return _Turn(
        ca.Function("turned", [x, step], [turned @ (x - away)], _CALL),
        ca.Function("turned_slope", [slope, step], [turned @ slope], _CALL),
        ca.Function("turned_weight", [mu, step], [turned.T @ mu], _CALL),
    )


def _scaled(vehicle: Vehicle) -> ca.Function:
    """f in scaled states and inputs."""
    X, U = ca.SX.sym("X", len(vehicle.scale)), ca.SX.sym("U", len(vehicle.input_scale))
    c = [ca.SX.sym("c", vehicle.f.size1_in(2))] if vehicle.f.n_in() > 2 else []
    scale, input_scale = ca.DM(vehicle.scale), ca.DM(vehicle.input_scale)
    return ca.Function("scaled", [X, U, *c], [ca.cse(vehicle.f(scale * X, input_scale * U, *c) / scale)])


def _columns(s: Symbols) -> Index:
    """(m, n_y): where the state, input and length of each interval are among the decision variables."""
    (n, nodes), (n_u, m) = s.X.shape, s.U.shape
    X = np.arange(n * m).reshape(m, n)
    U = n * nodes + np.arange(n_u * m).reshape(m, n_u)
    T = n * nodes + n_u * m + np.broadcast_to(np.arange(s.T.numel()), m)
    return np.column_stack([X, U, T])


def _scattered(blocks: ca.MX, pattern: ca.Sparsity, rows: Index, columns: Index, shape: tuple[int, int]) -> ca.MX:
    """The matrix with entry (i, j) of block k, all of one `pattern` and side by side, at rows[k, i], columns[k, j].

    Entries that meet are added.
    """
    i, j = (np.array(part) for part in (pattern.row(), pattern.get_col()))
    places, target = np.unique((columns[:, j] * shape[0] + rows[:, i]).ravel(), return_inverse=True)
    whole = ca.Sparsity.triplet(*shape, (places % shape[0]).tolist(), (places // shape[0]).tolist())
    count = len(target)
    gather = ca.DM.triplet(target.tolist(), range(count), ca.DM.ones(count), len(places), count)
    return ca.MX(whole, gather @ blocks.nz[:])
