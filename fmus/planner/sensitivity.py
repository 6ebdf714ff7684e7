"""A Runge-Kutta step with its first and second derivatives, differentiated stage by stage.

Each stage needs f, its Jacobian and its Hessian once, in one flat function with shared terms: a quarter of the time
that the general forward-over-reverse derivatives of CasADi take, which go through the whole step once per direction.
z = (x, u, h) are the arguments of a step, V_i = d(x_i, u)/dz those of stage i, K_i = dk_i/dz:

    x_i = x + c_i h k_{i-1},  k_i = f(x_i, u),  V_i = d(x + c_i h k_{i-1}, u)/dz,  K_i = f' V_i,  x+ = x + h sum b_i k_i
    d2(mu' x+)/dz2 = sum V_i' f''(nu_i) V_i + terms of h k_i,  nu_i = h b_i mu + c_{i+1} h (f_x' nu)_{i+1}
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import casadi as ca

Rule = Callable[..., Any]
_C, _B = (0.0, 0.5, 0.5, 1.0), (1 / 6, 1 / 3, 1 / 3, 1 / 6)


@dataclass(frozen=True, slots=True)
class Step:
    """`first` (x, u, h) -> x+, dx+/dz; `second` (x, u, h, mu) -> upper triangle of d2(mu' x+)/dz2.

    Both take the constants of f, if it has some, as their last argument.
    """

    first: ca.Function
    second: ca.Function


@dataclass(frozen=True, slots=True)
class _Stages:
    """What the four stages of a step leave behind for the second derivatives."""

    x: list[ca.SX]
    jacobian: list[ca.SX]
    V: list[ca.SX]
    K: list[ca.SX]
    end: ca.SX
    slope: ca.SX


def step(f: ca.Function) -> Step:
    """The classical Runge-Kutta step of x' = f(x, u) or f(x, u, c), with the input held."""
    n, n_u = f.size1_in(0), f.size1_in(1)
    x, u, h, mu = ca.SX.sym("x", n), ca.SX.sym("u", n_u), ca.SX.sym("h"), ca.SX.sym("mu", n)
    c = [ca.SX.sym("c", f.size1_in(2))] if f.n_in() > 2 else []
    f_x, f_xx = (_given(function, c) for function in _derivatives(f))
    stages = _stages(f_x, x, u, h)
    inline = {"never_inline": True}
    return Step(
        ca.Function("first", [x, u, h, *c], ca.cse([stages.end, stages.slope]), inline),
        ca.Function("second", [x, u, h, mu, *c], [ca.cse(ca.triu(_curvature(f_xx, stages, u, h, mu)))], inline),
    )


def _given(function: ca.Function, constants: list[ca.SX]) -> Rule:
    """The function with its last arguments filled in."""
    return lambda *arguments: function(*arguments, *constants)


def _derivatives(f: ca.Function) -> tuple[ca.Function, ca.Function]:
    """(x, u, c) -> f, df/d(x, u) and (x, u, nu, c) -> d2(nu' f)/d(x, u)2; without c if f has none."""
    x, u, nu = ca.SX.sym("x", f.size1_in(0)), ca.SX.sym("u", f.size1_in(1)), ca.SX.sym("nu", f.size1_in(0))
    c = [ca.SX.sym("c", f.size1_in(2))] if f.n_in() > 2 else []
    both, rate = ca.vertcat(x, u), f(x, u, *c)
    hessian = ca.hessian(ca.dot(nu, rate), both)[0]
    return (
        ca.Function("f_x", [x, u, *c], ca.cse([rate, ca.jacobian(rate, both)])),
        ca.Function("f_xx", [x, u, nu, *c], [ca.cse(hessian)]),
    )


def _stages(f_x: Rule, x: ca.SX, u: ca.SX, h: ca.SX) -> _Stages:
    n, n_u = x.numel(), u.numel()
    of_x = ca.horzcat(ca.SX.eye(n), ca.SX(n, n_u + 1))
    of_u = ca.horzcat(ca.SX(n_u, n), ca.SX.eye(n_u), ca.SX(n_u, 1))
    points, jacobians, Vs, Ks = [], [], [], []
    k, K, end, slope = ca.SX(n, 1), ca.SX(n, n + n_u + 1), x, of_x
    for c, b in zip(_C, _B, strict=True):
        points.append(x + c * h * k)
        Vs.append(ca.vertcat(of_x + _of_product(c, h, k, K), of_u))
        k, jacobian = f_x(points[-1], u)
        K = jacobian @ Vs[-1]
        jacobians.append(jacobian)
        Ks.append(K)
        end, slope = end + b * h * k, slope + _of_product(b, h, k, K)
    return _Stages(points, jacobians, Vs, Ks, end, slope)


def _of_product(factor: float, h: ca.SX, k: ca.SX, K: ca.SX) -> ca.SX:
    """d(factor h k)/dz, h being the last of z."""
    return factor * (h * K + ca.horzcat(ca.SX(K.size1(), K.size2() - 1), k)) if factor else ca.SX(*K.shape)


def _curvature(f_xx: Rule, stages: _Stages, u: ca.SX, h: ca.SX, mu: ca.SX) -> ca.SX:
    """d2(mu' x+)/dz2, backwards over the stages; `pull` is the weight of k_i without the factor h."""
    size, n = stages.slope.size2(), mu.numel()
    total, pull = ca.SX(size, size), ca.SX(n, 1)
    for i in reversed(range(len(_B))):
        pull = _B[i] * mu + pull
        total += stages.V[i].T @ f_xx(stages.x[i], u, h * pull) @ stages.V[i] + _border(pull.T @ stages.K[i])
        pull = _C[i] * (stages.jacobian[i][:, :n].T @ (h * pull))
    return total


def _border(row: ca.SX) -> ca.SX:
    """The matrix of the product h (row z): the row last, and its transpose."""
    size = row.numel()
    last = ca.vertcat(ca.SX(size - 1, size), row)
    return last + last.T
