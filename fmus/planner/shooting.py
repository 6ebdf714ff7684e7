"""One interval of the multiple shooting: Runge-Kutta over substeps with the input held, and its derivatives."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import casadi as ca

from fmukit.integration import rk4
from fmus.planner import sensitivity

_CALL: dict[str, Any] = {"never_inline": True}


def interval(f: ca.Function, substeps: int) -> ca.Function:
    """(x, u, T) -> x after T seconds by the classical Runge-Kutta method; (x, u, T, c) if f has a third argument c.

    One substep is a function of its own, so that its derivatives are generated once, however many there are. There
    are none with respect to the constants c.
    """
    x, u, T = ca.MX.sym("x", f.size1_in(0)), ca.MX.sym("u", f.size1_in(1)), ca.MX.sym("T")
    constants = [ca.MX.sym("c", f.size1_in(2))] if f.n_in() > 2 else []
    step, state = _substep(f), x
    for _ in range(substeps):
        state = step(state, u, T / substeps, *constants)
    names = ["x", "u", "T", "c"][: 3 + len(constants)]
    return ca.Function("interval", [x, u, T, *constants], [state], names, ["end"])


def _substep(f: ca.Function) -> ca.Function:
    x, u, h = ca.SX.sym("x", f.size1_in(0)), ca.SX.sym("u", f.size1_in(1)), ca.SX.sym("h")
    constants = [ca.SX.sym("c", f.size1_in(2))] if f.n_in() > 2 else []
    end = ca.cse(rk4(lambda at, _: f(at, u, *constants), x, h))
    differentiable = {"is_diff_in": [True] * 3 + [False] * len(constants)}
    return ca.Function("substep", [x, u, h, *constants], [end], _CALL | differentiable)


@dataclass(frozen=True, slots=True)
class Derivatives:
    """Of the end x+ of an interval in y = (x, u, T), of size n_y.

    `first` (x, u, T) -> dx+/dy (n, n_y); `second` (x, u, T, mu) -> upper triangle of d2(mu' x+)/dy2 (n_y, n_y). Both
    take the constants of f, if it has some, as their last argument.
    """

    first: ca.Function
    second: ca.Function


def derivatives(f: ca.Function, substeps: int) -> Derivatives:
    """First and second derivatives of `interval(f, substeps)`, chained from those of one substep."""
    x, u, T, mu = (ca.MX.sym("y", size) for size in (f.size1_in(0), f.size1_in(1), 1, f.size1_in(0)))
    constants = [ca.MX.sym("c", f.size1_in(2))] if f.n_in() > 2 else []
    step, h = sensitivity.step(f), T / substeps
    states, slopes = [x], []
    for _ in range(substeps):
        end, slope = step.first(states[-1], u, h, *constants)
        states.append(end)
        slopes.append(slope)
    rules = _rules(step)
    totals = [ca.project(slopes[0], rules.pattern)]
    for slope in slopes[1:]:
        totals.append(rules.chained(slope, totals[-1]))
    H, weight = ca.MX(*step.second.size_out(0)), mu
    for j in reversed(range(substeps)):
        own = step.second(states[j], u, h, weight, *constants)
        H = H + (rules.bent(totals[j - 1], own) if j else own)
        weight = rules.pulled(slopes[j], weight)
    scale = ca.DM.ones(f.size1_in(0) + f.size1_in(1) + 1)
    scale[-1] = 1 / substeps
    return Derivatives(
        ca.Function("first_derivative", [x, u, T, *constants], [totals[-1] @ ca.diag(scale)]),
        ca.Function("second_derivative", [x, u, T, mu, *constants], [ca.diag(scale) @ H @ ca.diag(scale)]),
    )


@dataclass(frozen=True, slots=True)
class _Rules:
    """Products of sparse matrices as flat functions; `pattern` is that of dx_j/d(x, u, h) for every j >= 1.

    `chained` (S, A) -> S W, `bent` (A, H) -> triu W' H W, `pulled` (S, mu) -> S_x' mu, with W = (A; 0 I) the
    derivative of (x_j, u, h).
    """

    pattern: ca.Sparsity
    chained: ca.Function
    bent: ca.Function
    pulled: ca.Function


def _rules(step: sensitivity.Step) -> _Rules:
    S = ca.SX.sym("S", step.first.sparsity_out(1))
    H = ca.SX.sym("H", step.second.sparsity_out(0))
    n, mu = S.size1(), ca.SX.sym("mu", S.size1())
    pattern = S.sparsity()
    for _ in range(n):
        pattern = pattern + (S @ _with_inputs(ca.SX(pattern))).sparsity()
    A = ca.SX.sym("A", pattern)
    W = _with_inputs(A)
    full = H + H.T - ca.diag(ca.diag(H))
    return _Rules(
        pattern,
        ca.Function("chained", [S, A], [ca.cse(ca.project(S @ W, pattern))], _CALL),
        ca.Function("bent", [A, H], [ca.cse(ca.triu(W.T @ full @ W))], _CALL),
        ca.Function("pulled", [S, mu], [S[:, :n].T @ mu], _CALL),
    )


def _with_inputs(A: ca.SX) -> ca.SX:
    """(A; 0 I): A (n, n_y) with the rows of u and h below."""
    n, n_y = A.shape
    return ca.vertcat(A, ca.horzcat(ca.SX(n_y - n, n), ca.SX.eye(n_y - n)))
