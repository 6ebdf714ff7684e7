"""A quadratic program as a CasADi function, the same code in this process and inside an FMU."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca

from fmukit.qp.codegen import COMMON, sources
from fmukit.qp.library import compiled
from fmukit.qp.settings import QpSettings

_NAME = re.compile(r"[a-z][a-z0-9_]*")


@dataclass(frozen=True, slots=True)
class QpSolver:
    """`function` for models; `sources` (texts by file name) and `units` (those to compile) for the build.

    function: (P, q, A, l, u, x0, y0, rho, timed) -> (x, y, rho, status, iterations, primal, dual, time)
    P, A: patterns of the matrices, P the upper triangle
    """

    name: str
    P: ca.Sparsity = field(repr=False)
    A: ca.Sparsity = field(repr=False)
    settings: QpSettings
    function: ca.Function
    sources: Mapping[str, str] = field(repr=False)
    units: tuple[str, ...]


def qp_solver(name: str, P: ca.Sparsity, A: ca.Sparsity, settings: QpSettings | None = None) -> QpSolver:
    """A solver of min x'Px/2 + q'x, l <= Ax <= u; P (n x n) upper triangle, A (m x n).

    P and A are given as columns of their nonzeros in CasADi's order. Compiled once and kept in the user's cache.
    Raises ValueError for patterns that do not fit, `fmukit.errors.BuildError` without a compiler.
    """
    _check(name, P, A)
    settings = settings or QpSettings()
    symbol = f"qp_{name}"
    texts = sources(symbol, P, A, settings)
    units = (COMMON, f"{symbol}.c")
    path = compiled(symbol, texts, units)
    return QpSolver(name, P, A, settings, ca.external(symbol, str(path)), texts, units)


def _check(name: str, P: ca.Sparsity, A: ca.Sparsity) -> None:
    if not _NAME.fullmatch(name):
        raise ValueError(f"qp_solver: the name {name!r} must be lower case letters, digits and _, a letter first")
    if not P.is_square() or not P.is_triu():
        raise ValueError(
            f"qp_solver {name}: P ({P.size1()} x {P.size2()}) must be the upper triangle of a square matrix"
        )
    if A.size2() != P.size1():
        raise ValueError(f"qp_solver {name}: A has {A.size2()} columns, P has {P.size1()}; they must be equal")
    if not P.nnz() or not A.nnz():
        raise ValueError(f"qp_solver {name}: P and A need at least one nonzero each")
