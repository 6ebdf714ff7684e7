"""The two quadratic programs of a sample: built, solved, and their solutions read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import casadi as ca

from fmukit.qp import QpSettings, QpSolver, qp_solver
from fmus.controllers.mpc_allocator import linearise, tracking_qp, wheels
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.double_track import distribution

Parameters = Callable[[str], ca.MX]
_PARAMETERS = INTERFACE.names("parameter")
_ERRORS = ("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate", "steer_angle", "terminal")
_EFFORTS = ("steer", "force", "force", "steer_change", "force_change", "force_change")
_WEIGHTS = (*(f"weight.{name}" for name in (*_ERRORS, *_EFFORTS)), "corridor.weight", "corridor.half_width")
_TRACKING = QpSettings(rho=8.0, absolute=1e-4, relative=1e-4, iterations=300, check=10, adapt=20)
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


def parameter(p: ca.MX) -> Parameters:
    """Parameters by name."""
    return lambda name: p[_PARAMETERS.index(name)]


@cache
def prediction() -> ca.Function:
    """`linearise.function`, made once."""
    return linearise.function()


@cache
def program() -> tracking_qp.Pattern:
    """The prediction's program, made once."""
    found = prediction()
    return tracking_qp.pattern(found.sparsity_out(0), found.sparsity_out(1))


@cache
def solvers() -> tuple[QpSolver, QpSolver]:
    """Of the prediction and of the distribution."""
    return (
        qp_solver("tracking", program().P, program().A, _TRACKING),
        qp_solver("wheels", distribution.PATTERN_P, distribution.PATTERN_A, WHEEL_SETTINGS),
    )


def predict(
    p: ca.MX, x: dict[str, ca.MX], nodes: ca.MX, e: ca.MX, d: ca.MX, bounds: tuple[ca.MX, ca.MX, ca.MX]
) -> tuple[ca.MX, ca.MX, Solved]:
    """Inputs of the reference and inputs found (3 x NODES each), and what the solver gave.

    `bounds`: low and high at once, low and high later (3 x 2 each), step per node (3).
    """
    Phi, Gamma, c, u_r, e_steady, w_steady = prediction().map(NODES)(
        ca.repmat(p, 1, NODES), nodes[:, :-1], nodes[:, 1:], ca.repmat(d, 1, NODES)
    )
    get = parameter(p)
    weights = ca.vertcat(*(get(name) for name in _WEIGHTS))
    numbers = program().numbers(Phi, Gamma, c, u_r, e_steady, w_steady, e, x["beside"], *bounds, weights)
    start = (x["solution"], x["multipliers"], x["penalty"], get("solver.timed"))
    solved = _solve(solvers()[0], *numbers, *start)
    return u_r, tracking_qp.inputs(solved.x, u_r), solved


def distribute(p: ca.MX, x: dict[str, ca.MX], u: ca.MX, delta: ca.MX, reach: ca.MX) -> tuple[ca.MX, ca.MX, Solved]:
    """Forces of the wheels (4) [N] within `reach` (4 x 2), what they miss (3), and what the solver gave."""
    numbers = wheels.program()(p, u, delta, x["forces"], reach)
    start = (x["forces"] / distribution.N, x["wheel_multipliers"], x["wheel_penalty"])
    solved = _solve(solvers()[1], *numbers, *start, parameter(p)("solver.timed"))
    U, missed = wheels.result()(p, u, delta, solved.x, solved.good, reach)
    return U, missed, solved


def _solve(solver: QpSolver, *arguments: ca.MX) -> Solved:
    x, y, rho, status, iterations, _, _, time = solver.function.call(list(arguments))
    return Solved(x, y, rho, status, iterations, time)
