"""The two quadratic programs of a sample: built, solved, and their solutions read."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca

from fmukit.kernel import Block, Parts, Signals
from fmukit.qp import QpSettings, QpSolver, qp_solver
from fmus.controllers.mpc_allocator import linearise, tracking_qp, wheels
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.double_track import distribution

_ERRORS = ("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate", "steer_angle", "terminal")
_EFFORTS = ("steer", "force", "force", "steer_change", "force_change", "force_change")
WEIGHTS = (*(f"weight.{name}" for name in (*_ERRORS, *_EFFORTS)), "corridor.weight", "corridor.half_width")
TRACKING = QpSettings(rho=8.0, absolute=1e-4, relative=1e-4, iterations=300, check=10, adapt=20)
WHEEL_SETTINGS = QpSettings(rho=1.0, absolute=1e-6, relative=1e-6, iterations=2000, check=5, adapt=20)
"""Ten times tighter than 1e-5: five iterations more of some 20, and 0.004 instead of 10 N of error per wheel."""
_SOLVED = (1, 2)


@dataclass(frozen=True, slots=True)
class Solved:
    """What a solver gave: solution, multipliers and penalty to start from, status, iterations and time [s]."""

    x: ca.MX
    y: ca.MX
    rho: ca.MX
    status: ca.MX
    iterations: ca.MX
    time: ca.MX

    @property
    def good(self) -> ca.MX:
        """1 when the solution can be used."""
        return ca.logic_or(*(self.status == value for value in _SOLVED))


@cache
def program() -> Block:
    """The prediction's program, made once."""
    pattern = linearise.predicted.function.sparsity_out
    return tracking_qp.program(pattern(0), pattern(1))


@cache
def solvers() -> tuple[QpSolver, QpSolver]:
    """Of the prediction and of the distribution."""
    pattern = program().function.sparsity_out
    return (
        qp_solver("tracking", pattern(0), pattern(2), TRACKING),
        qp_solver("wheels", distribution.PATTERN_P, distribution.PATTERN_A, WHEEL_SETTINGS),
    )


def predict(
    p: Signals, x: Parts, nodes: ca.MX, e: ca.MX, d: ca.MX, bounds: tuple[ca.MX, ca.MX, ca.MX]
) -> tuple[ca.MX, ca.MX, Solved]:
    """Inputs of the reference and inputs found (3 x NODES each), and what the solver gave.

    `bounds`: low and high at once, low and high later (3 x 2 each), step per node (3).
    """
    found = linearise.predicted.function.map(NODES)(
        ca.repmat(p.column, 1, NODES), nodes[:, :-1], nodes[:, 1:], ca.repmat(d, 1, NODES)
    )
    P, q, A, low, high = program()(*found, e, x["beside"], *bounds, p.pick(WEIGHTS))
    start = (x["solution"], x["multipliers"], x["penalty"], p["solver.timed"])
    solved = _solve(solvers()[0], P.nz[:], q, A.nz[:], low, high, *start)
    u_r = found[3]
    return u_r, tracking_qp.inputs(solved.x, u_r), solved


def distribute(p: Signals, x: Parts, u: ca.MX, delta: ca.MX, reach: ca.MX) -> tuple[ca.MX, ca.MX, Solved]:
    """Forces of the wheels (4) [N] within `reach` (4 x 2), what they miss (3), and what the solver gave."""
    numbers = wheels.program(p, u, delta, x["forces"], reach)
    start = (x["forces"] / distribution.N, x["wheel_multipliers"], x["wheel_penalty"])
    solved = _solve(solvers()[1], *numbers, *start, p["solver.timed"])
    U, missed = wheels.result(p, u, delta, solved.x, solved.good, reach)
    return U, missed, solved


def _solve(solver: QpSolver, *arguments: ca.MX) -> Solved:
    x, y, rho, status, iterations, _, _, time = solver.function.call(list(arguments))
    return Solved(x, y, rho, status, iterations, time)
