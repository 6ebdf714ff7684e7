"""Quadratic programs inside a kernel: `qp_solver` makes OSQP's generated C a CasADi function (see README.md)."""

from fmukit.qp.settings import QpSettings
from fmukit.qp.solver import QpSolver, qp_solver

__all__ = ["QpSettings", "QpSolver", "qp_solver"]
