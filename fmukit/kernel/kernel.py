"""The functions of one component as the runtime calls them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import casadi as ca

if TYPE_CHECKING:
    from fmukit.qp.solver import QpSolver


@dataclass(frozen=True, slots=True)
class Kernel:
    """Pure CasADi functions of dense columns in slot order; the letters are those of `fmukit.kernel`, y are outputs.

    initialise  (p, u, w, table, rows) -> (d, x, y)
    step        sampled:    (p, d, u, x, w, t) -> (x, y)
                continuous: (p, d, u, x, h) -> (x), one substep
    output      continuous only: (p, d, u, x) -> (y)
    solvers     the quadratic programs the functions call; ValueError names one that is called but not given
    derivative  continuous and integrated only: (p, d, u, x) -> (x')
    """

    initialise: ca.Function
    step: ca.Function
    output: ca.Function | None = None
    solvers: tuple[QpSolver, ...] = ()
    derivative: ca.Function | None = None
