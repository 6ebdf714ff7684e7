"""MpcAllocator: from the trajectory bus and the estimate to steering angle and wheel torques."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

import casadi as ca

from fmukit.kernel import Kernel, Layout, sampled_kernel, stack
from fmukit.qp import QpSettings, QpSolver, qp_solver
from fmus.controllers.mpc_allocator import (
    distribution,
    horizon,
    limits,
    linearise,
    observe,
    plan,
    tracking_qp,
    wheels,
)
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U, N_X
from fmus.wheels import WHEELS

STATES = Layout(
    started=1,  # 0 before the first sample with usable inputs
    zero_dynamics=2,  # sideslip and yaw rate of the car on the reference
    reference=4,  # x, y, course and speed when the reference moved last
    age=1,  # s since then
    car=N_X,  # estimated state of the car at the sample before
    known=1,  # 1 when that is of the sample just before
    forces=4,  # of the wheels since then [N]
    command=1,  # steering angle asked for since then [rad]
    acceleration=2,  # of the body then, behind the wheel loads [m/s2]
    disturbance=N_X - 1,
    beside=N_U,  # inputs applied then less those of the reference
    motors=4,  # motors available then
    plan=N_U * NODES,  # inputs planned
    alone=1,  # s since a plan was found
    fallbacks=1,
    solution=tracking_qp.SIZE,
    multipliers=tracking_qp.ROWS,
    penalty=1,
    wheel_multipliers=4,
    wheel_penalty=1,
)
DERIVED = Layout()
_PARAMETERS = INTERFACE.names("parameter")
_INPUTS = INTERFACE.names("input")
_OUTPUTS = INTERFACE.names("output")
_ABSURD = 1e9  # beyond it a number on an input is no measurement
_STANDING = 0.01  # m/s: a reference this slow need not move
_SOLVED = (1, 2)
_WEIGHTS = (
    *("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate", "steer_angle", "terminal"),
    *("steer", "force", "force", "steer_change", "force_change", "force_change"),
)
_SETTINGS = QpSettings(absolute=1e-4, relative=1e-4, iterations=400, check=10, adapt=50)
_WHEEL_SETTINGS = QpSettings(absolute=1e-6, relative=1e-6, iterations=400, check=5, adapt=50)


def kernel() -> Kernel:
    """The kernel; every sample solves the prediction's program, then the distribution's."""
    return sampled_kernel(
        INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step(), solvers=solvers()
    )


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
        qp_solver("tracking", program().P, program().A, _SETTINGS),
        qp_solver("wheels", distribution.PATTERN_P, distribution.PATTERN_A, _WHEEL_SETTINGS),
    )


def _initialise() -> ca.Function:
    p, u = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("u", len(_INPUTS))
    arguments = [p, u, ca.MX.sym("w", 0), ca.MX.sym("table", 0), ca.MX.sym("rows")]
    start = {name: ca.MX.zeros(size) for name, size in STATES.sizes.items()}
    start |= {"alone": ca.MX(plan.LENGTH), "motors": ca.MX.ones(4)}
    return ca.Function("initialise", arguments, [ca.MX(0, 1), STATES.join(start), ca.MX.zeros(len(_OUTPUTS))])


def _step() -> ca.Function:
    p, d, u = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("d", 0), ca.MX.sym("u", len(_INPUTS))
    x = ca.MX.sym("x", STATES.size)
    after, y = sample(p, u, STATES.split(x))
    arguments = [p, d, u, x, ca.MX.sym("w", 0), ca.MX.sym("t")]
    return ca.Function("step", arguments, [STATES.join(after), stack(_OUTPUTS, y)])


def sample(p: ca.MX, u: ca.MX, x: dict[str, ca.MX]) -> tuple[dict[str, ca.MX], dict[str, ca.MX]]:
    """States and outputs of one sample."""
    get = _parameter(p)
    Ts = get("sample_period")
    finite = ca.fabs(u) <= _ABSURD
    usable, u = ca.mmin(finite), ca.if_else(finite, u, 0)
    age, marker = _age(u, x, usable, Ts)
    path, ahead = horizon.samples(u, ca.fmin(age, get("trajectory.timeout")), Ts)
    z = ca.if_else(x["started"], x["zero_dynamics"], horizon.steady(p, path))
    nodes = horizon.reference(p, z, path)
    car, e, near, dist, acceleration = _observe(p, u, x, nodes[:, 0], usable, Ts)
    motors = ca.if_else(usable, _named(u, "motor_available"), x["motors"])
    first, later, step, reach = limits.function()(p, car, x["acceleration"], motors, x["forces"], x["command"], Ts)
    u_r, solved = _predict(p, x, nodes, near, dist, (first, later, step))
    good = usable * (age <= get("trajectory.timeout")) * _is_solved(solved["status"])
    found = tracking_qp.inputs(solved["x"], u_r)
    kept, wanted, alone = plan.function()(
        p, found, good, ca.reshape(x["plan"], N_U, NODES), x["alone"], x["command"], car[2], Ts
    )
    steer = ca.fmin(ca.fmax(wanted[0], first[0, 0]), first[0, 1])
    U, missed, shared = _distribute(p, x, wanted, car[6], reach)
    after = {
        "started": ca.fmax(x["started"], usable),
        "zero_dynamics": ca.if_else(usable, horizon.later(p, z, path, ahead, Ts), x["zero_dynamics"]),
        "reference": marker,
        "age": age,
        "car": car,
        "known": usable,
        "forces": U,
        "command": steer,
        "acceleration": acceleration,
        "disturbance": dist,
        "beside": ca.vertcat(steer, limits.sides(U)) - u_r[:, 0],
        "motors": motors,
        "plan": ca.vec(kept),
        "alone": alone,
        "fallbacks": x["fallbacks"] + (1 - good),
        "solution": tracking_qp.moved_on(solved["x"]),
        "multipliers": tracking_qp.multipliers_moved_on(solved["y"]),
        "penalty": solved["rho"],
        "wheel_multipliers": shared["y"],
        "wheel_penalty": shared["rho"],
    }
    course = e[3] + e[4]
    y = {
        **{f"wheel_torque.{wheel}": get("design.wheel.radius") * U[i] for i, wheel in enumerate(WHEELS)},
        "command.steer_angle": steer,
        **_outputs("error", ("longitudinal", "lateral", "speed", "course"), ca.vertcat(e[:3], course)),
        "demand.force_x": wanted[1] + wanted[2],
        "demand.moment_z": get("design.geometry.half_track") * (wanted[2] - wanted[1]),
        **_outputs("residual", ("force_x", "force_y", "moment_z"), missed),
        **_outputs("disturbance", ("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate"), dist),
        "solver.status": solved["status"] * usable,
        "allocation.status": shared["status"],
        "fallback.active": 1 - good,
        "fallback.count": after["fallbacks"],
        "trajectory.age": age,
    }
    for name in ("iterations", "time"):
        y[f"solver.{name}"], y[f"allocation.{name}"] = solved[name], shared[name]
    return after, y


def _parameter(p: ca.MX) -> Callable[[str], ca.MX]:
    return lambda name: p[_PARAMETERS.index(name)]


def _named(u: ca.MX, group: str) -> ca.MX:
    return ca.vertcat(*(u[_INPUTS.index(f"{group}.{wheel}")] for wheel in WHEELS))


def _outputs(group: str, names: tuple[str, ...], values: ca.MX) -> dict[str, ca.MX]:
    return {f"{group}.{name}": value for name, value in zip(names, ca.vertsplit(values), strict=True)}


def _age(u: ca.MX, x: dict[str, ca.MX], usable: ca.MX, Ts: ca.MX) -> tuple[ca.MX, ca.MX]:
    """Time since the reference last moved [s], and its values by which the next sample will tell."""
    seen = ca.vertcat(*(u[_INPUTS.index(f"reference.{name}")] for name in ("x", "y", "course", "speed")))
    same = ca.mmin(seen == x["reference"]) * (seen[3] > _STANDING) * x["started"]
    aged = ca.fmin(x["age"] + Ts, 1e6)
    age = ca.if_else(usable, ca.if_else(same, aged, 0), aged)
    return age, ca.if_else(usable, seen, x["reference"])


def _observe(p: ca.MX, u: ca.MX, x: dict[str, ca.MX], node: ca.MX, usable: ca.MX, Ts: ca.MX) -> tuple[ca.MX, ...]:
    """Car, errors, limited errors, disturbance and accelerations; without usable inputs those of the sample before."""
    learning = x["known"] * usable
    seen = observe.function()(
        p, u, node, x["car"], x["forces"], x["acceleration"], x["command"], x["disturbance"], learning, Ts
    )
    car, e, near, dist, acceleration = seen
    return (
        ca.if_else(usable, car, x["car"]),
        ca.if_else(usable, e, 0),
        ca.if_else(usable, near, 0),
        ca.if_else(usable, dist, x["disturbance"]),
        ca.if_else(usable, acceleration, x["acceleration"]),
    )


def _predict(
    p: ca.MX, x: dict[str, ca.MX], nodes: ca.MX, e: ca.MX, d: ca.MX, bounds: tuple[ca.MX, ca.MX, ca.MX]
) -> tuple[ca.MX, dict[str, ca.MX]]:
    """Inputs of the reference (3 x NODES), and what the solver found."""
    Phi, Gamma, c, u_r, e_steady, w_steady = prediction().map(NODES)(
        ca.repmat(p, 1, NODES), nodes[:, :-1], nodes[:, 1:], ca.repmat(d, 1, NODES)
    )
    first, later, step = bounds
    get = _parameter(p)
    weighed = [get(f"weight.{name}") for name in _WEIGHTS]
    weights = ca.vertcat(*weighed, get("corridor.weight"), get("corridor.half_width"))
    numbers = program().numbers(Phi, Gamma, c, u_r, e_steady, w_steady, e, x["beside"], first, later, step, weights)
    start = (x["solution"], x["multipliers"], x["penalty"], get("solver.timed"))
    return u_r, _solved(solvers()[0], *numbers, *start)


def _distribute(
    p: ca.MX, x: dict[str, ca.MX], u: ca.MX, delta: ca.MX, reach: ca.MX
) -> tuple[ca.MX, ca.MX, dict[str, ca.MX]]:
    """Forces of the wheels [N], what they miss, and what the solver found."""
    numbers = wheels.program()(p, u, delta, x["forces"], reach)
    start = (x["forces"] / distribution.N, x["wheel_multipliers"], x["wheel_penalty"])
    found = _solved(solvers()[1], *numbers, *start, _parameter(p)("solver.timed"))
    U, missed = wheels.result()(p, u, delta, found["x"], _is_solved(found["status"]), reach)
    return U, missed, found


def _solved(solver: QpSolver, *arguments: ca.MX) -> dict[str, ca.MX]:
    names = ("x", "y", "rho", "status", "iterations", "primal", "dual", "time")
    return dict(zip(names, solver.function.call(list(arguments)), strict=True))


def _is_solved(status: ca.MX) -> ca.MX:
    return ca.logic_or(*(status == value for value in _SOLVED))
