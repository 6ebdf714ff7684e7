"""The quadratic programs a component meets in its reference run, with the start each is solved from."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import casadi as ca
import numpy as np
from scipy import sparse

from fmukit.component import Component
from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmukit.qp import QpSolver
from fmukit.reference_run import reference_run


@dataclass(frozen=True)
class Problem:
    """min 1/2 x'Px + q'x, l <= Ax <= u, from (x0, y0, rho); P (n x n) is the upper triangle, A (m x n)."""

    P: sparse.csc_matrix
    q: np.ndarray
    A: sparse.csc_matrix
    l: np.ndarray  # noqa: E741
    u: np.ndarray
    x0: np.ndarray
    y0: np.ndarray
    rho: float

    @cached_property
    def full(self) -> sparse.csc_matrix:
        """P, both triangles."""
        return sparse.csc_matrix(self.P + sparse.triu(self.P, 1).T)

    def arguments(self, *, timed: bool) -> list[ca.DM]:
        """Those of the generated C."""
        numbers = (self.P.data, self.q, self.A.data, self.l, self.u, self.x0, self.y0, self.rho, float(timed))
        return [ca.DM(number) for number in numbers]

    def cost(self, x: np.ndarray) -> float:
        """The objective at x."""
        return float(x @ (self.full @ x) / 2 + self.q @ x)

    def violation(self, x: np.ndarray) -> float:
        """How far A x is outside its bounds, largest row."""
        return float(np.maximum(self.l - self.A @ x, self.A @ x - self.u).max())


def recorded(component: Component, kernel: Kernel) -> dict[str, list[Problem]]:
    """For every solver of the kernel, by its name, its problems in the order of the samples."""
    run = reference_run(component)
    if run is None:
        raise ValueError(f"{component.interface.name} has no reference run")
    instance = Direct(component, inputs=run.inputs(0.0), kernel=kernel)
    seen: dict[str, list[Problem]] = {solver.name: [] for solver in kernel.solvers}
    asked = [(solver, _asked(kernel.step, solver.function.name())) for solver in kernel.solvers]
    for k in range(round(run.stop / component.interface.step)):
        t = k * component.interface.step
        instance.set(run.inputs(t))
        for solver, function in asked:
            values = function(instance.p, instance.d, instance.u, instance.x, ca.DM.zeros(0), t)
            seen[solver.name].append(_problem(solver, values))
        instance.sample()
    return seen


def _problem(solver: QpSolver, values: tuple[ca.DM, ...]) -> Problem:
    P, q, A, low, high, x0, y0, rho, _ = (value.full().ravel() for value in values)
    return Problem(_matrix(solver.P, P), q, _matrix(solver.A, A), low, high, x0, y0, float(rho[0]))


def _matrix(pattern: ca.Sparsity, values: np.ndarray) -> sparse.csc_matrix:
    return sparse.csc_matrix((values, pattern.row(), pattern.colind()), shape=pattern.shape)


def _asked(step: ca.Function, solver: str) -> ca.Function:
    """(arguments of a sample) -> arguments of the solver, from the graph of the sample."""
    for i in range(step.n_instructions()):
        node = step.instruction_MX(i)
        if node.is_call() and node.which_function().name() == solver:
            return ca.Function("asked", step.mx_in(), [node.dep(j) for j in range(node.n_dep())])
    raise ValueError(f"{step.name()} does not call {solver}")
