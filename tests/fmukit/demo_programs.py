"""A sampled component with two quadratic programs, for tests of fmukit only.

`spread` distributes a wanted sum over four bounded values; `plan` drives a point of unit mass to a target by the first
of ten accelerations. Both keep their start and penalty in the component's state. The inputs `poison` and `crossed`
make the problems of a sample unusable.
"""

from __future__ import annotations

from functools import partial

import casadi as ca

from fmukit.component import Component
from fmukit.interface import input_, output, parameter, sampled
from fmukit.kernel import Kernel, Layout, Parts, Signals, sampled_kernel
from fmukit.qp import QpSettings, QpSolver, qp_solver

STEPS, STEP = 10, 0.1
STATES = Layout(x_s=4, y_s=4, rho_s=1, x_p=3 * STEPS, y_p=3 * STEPS + 1, rho_p=1, z=2)
_NAMES = [f"share[{i}]" for i in range(4)]
INTERFACE = sampled(
    "DemoPrograms",
    "Two quadratic programs: shares of a sum, and the plan of a moving point",
    step=STEP,
    variables=[
        parameter("limit", "1", "largest share and acceleration", 1.0, minimum=1e-3),
        parameter("solver.timed", "1", "whether solving is timed", False),
        input_("sum", "1", "wanted sum of the shares", minimum=-1e6, maximum=1e6),
        input_("target", "m", "wanted position", minimum=-1e6, maximum=1e6),
        input_("poison", "1", "1: the problems of this sample contain NaN"),
        input_("crossed", "1", "1: lower bounds above upper bounds"),
        input_("impossible", "1", "1: the plan must end far beyond reach"),
        *(output(name, "1", "share of the sum") for name in _NAMES),
        output("position", "m", "position of the point"),
        output("acceleration", "m/s2", "acceleration chosen"),
        *(output(f"{qp}.{what}", "1", what) for qp in ("spread", "plan") for what in ("status", "iterations", "rho")),
        output("plan.time", "s", "time to solve"),
    ],
)
COMPONENT = Component(INTERFACE, "demo_programs")


def spread_problem(total: ca.MX, limit: ca.MX) -> tuple[ca.MX, ...]:
    """min (sum x - total)^2 + sum w_i x_i^2 with |x_i| <= limit: P, q, A, l, u."""
    weights = ca.DM([0.1, 0.2, 0.3, 0.4])
    P = ca.triu(ca.DM.ones(4, 4) + ca.diag(weights))
    return P, -total * ca.DM.ones(4), ca.DM.eye(4), -limit * ca.DM.ones(4), limit * ca.DM.ones(4)


def plan_problem(x: ca.MX, target: ca.MX, limit: ca.MX, far: ca.MX) -> tuple[ca.MX, ...]:
    """States z_1..z_N = (position, speed), accelerations a_0..a_{N-1}; `far` moves the end 1000 m away."""
    n = 3 * STEPS
    F, g = ca.DM([[1, STEP], [0, 1]]), ca.DM([STEP**2 / 2, STEP])
    P = ca.DM(ca.diag([20.0, 1.0] * STEPS + [0.1] * STEPS))
    rows = ca.DM(2 * STEPS, n)
    for k in range(STEPS):
        rows[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = ca.DM.eye(2)
        rows[2 * k : 2 * k + 2, 2 * STEPS + k] = -g
        if k:
            rows[2 * k : 2 * k + 2, 2 * k - 2 : 2 * k] = -F
    inputs = ca.horzcat(ca.DM(STEPS, 2 * STEPS), ca.DM.eye(STEPS))
    end = ca.DM(1, n)
    end[0, 2 * STEPS - 2] = 1.0
    A = ca.vertcat(rows, inputs, end)
    start = ca.vertcat(F @ x, ca.DM.zeros(2 * STEPS - 2))
    low = ca.vertcat(start, -limit * ca.DM.ones(STEPS), ca.if_else(far, 1000.0, -ca.inf))
    high = ca.vertcat(start, limit * ca.DM.ones(STEPS), ca.inf)
    q = ca.vertcat(*([-20.0 * target, 0.0] * STEPS), ca.DM.zeros(STEPS))
    return ca.sparsify(P), q, ca.sparsify(A), low, high


def solvers() -> tuple[QpSolver, QpSolver]:
    zero = ca.MX.zeros(2)
    P, _, A, _, _ = spread_problem(zero[0], zero[0])
    spread = qp_solver("spread", P.sparsity(), A.sparsity(), QpSettings(absolute=1e-7, relative=0.0, check=5))
    P, _, A, _, _ = plan_problem(zero, zero[0], zero[0], zero[0])
    return spread, qp_solver("plan", P.sparsity(), A.sparsity(), QpSettings(absolute=1e-5, relative=0.0))


def kernel() -> Kernel:
    given = solvers()
    own = {"initialise": lambda: ({}, {}, {}), "sample": partial(sample, given)}
    return sampled_kernel(INTERFACE, states=STATES, symbol=ca.MX, solvers=given, **own)


def sample(solvers: tuple[QpSolver, QpSolver], p: Signals, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    def solve(solver: QpSolver, problem: tuple[ca.MX, ...], tag: str) -> tuple[ca.MX, ...]:
        P, q, A, low, high = problem
        q = q * ca.sqrt(1 - 2 * u["poison"])
        low = low + 1e7 * u["crossed"]
        start = (x[f"{name}_{tag}"] for name in ("x", "y", "rho"))
        return solver.function(P.nz[:], q, A.nz[:], low, high, *start, p["solver.timed"])

    one = solve(solvers[0], spread_problem(u["sum"], p["limit"]), "s")
    two = solve(solvers[1], plan_problem(x["z"], u["target"], p["limit"], u["impossible"]), "p")
    acceleration = ca.if_else(two[3] > 0, two[0][2 * STEPS], 0.0)
    position, speed = x["z"][0], x["z"][1]
    z = ca.vertcat(position + STEP * speed + STEP**2 / 2 * acceleration, speed + STEP * acceleration)
    after = {"x_s": one[0], "y_s": one[1], "rho_s": one[2], "x_p": two[0], "y_p": two[1], "rho_p": two[2], "z": z}
    y = {name: one[0][i] for i, name in enumerate(_NAMES)} | {"position": z[0], "acceleration": acceleration}
    for qp, result in (("spread", one), ("plan", two)):
        y |= {f"{qp}.status": result[3], f"{qp}.iterations": result[4], f"{qp}.rho": result[2]}
    return after, y | {"plan.time": two[7]}
