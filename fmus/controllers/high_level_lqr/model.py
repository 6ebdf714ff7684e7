"""HighLevelLqr: from the trajectory bus and the estimate to commands."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca

from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, stack, symbols
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD, REFERENCE, SAMPLE
from fmus.controllers.high_level_lqr import inversion, lag, leads, riccati, tracking
from fmus.controllers.high_level_lqr.interface import INTERFACE

STATES = Layout(
    started=1,  # 0 before the first sample, which starts the zero dynamics at their equilibrium
    zero_dynamics=2,  # sideslip and yaw rate of the linear single-track on the reference [rad, rad/s]
    integrals=2,  # of the longitudinal and lateral errors [m s]
    yaw_answer=1,  # yaw rate of the feedback as the car has answered it so far [rad/s]
    sideslip=1,  # slow part of measured minus expected sideslip [rad]
)
DERIVED = Layout(terminal=10)
_MOVING = 5.0  # m/s; below it the integrals grow more slowly, at rest not at all
_ERRORS = ("longitudinal", "speed", "lateral", "yaw")
_WEIGHTS = (*_ERRORS, "acceleration", "yaw_rate")
_PARAMETERS = INTERFACE.names("parameter")
_INPUTS = INTERFACE.names("input")


def kernel() -> Kernel:
    """The kernel; d holds the terminal weight."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("u", len(_INPUTS))
    v = _parameter(p)("terminal.speed")
    d = riccati.terminal(PREVIEW_PERIOD)(ca.vertcat(_weights(p), v, lag.reach(_parameter(p), v)))
    arguments = [p, u, ca.MX.sym("w", 0), ca.MX.sym("table", 0), ca.MX.sym("rows")]
    outputs = ca.MX.zeros(len(INTERFACE.names("output")))
    return ca.Function("initialise", arguments, [d, ca.MX.zeros(STATES.size), outputs])


def _step() -> ca.Function:
    p, d, u = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("d", DERIVED.size), ca.MX.sym("u", len(_INPUTS))
    x = ca.MX.sym("x", STATES.size)
    v, curvature = (_between(_along(u, name)) for name in ("speed", "curvature"))
    K = riccati.first_gain(PREVIEW_PERIOD, PREVIEW)(d, _weights(p), v, curvature, lag.reach(_parameter(p), v))
    arguments = [p, d, u, x, ca.MX.sym("w", 0), ca.MX.sym("t")]
    return ca.Function("step", arguments, list(_control().call([p, u, x, K])))


def _parameter(p: ca.MX) -> Callable[[str], ca.MX]:
    return lambda name: p[_PARAMETERS.index(name)]


def _weights(p: ca.MX) -> ca.MX:
    return ca.vertcat(*(_parameter(p)(f"weight.{name}") for name in _WEIGHTS))


def _along(u: ca.MX, name: str) -> ca.MX:
    """One quantity of the reference now and along the preview (1 x PREVIEW + 1)."""
    first, ahead = _INPUTS.index(f"reference.{name}"), _INPUTS.index(f"preview[1].{name}")
    last = ahead + len(SAMPLE) * PREVIEW
    return ca.horzcat(u[first], u[ahead : last : len(SAMPLE)].T)


def _between(nodes: ca.MX) -> ca.MX:
    """Means of neighbours (1 x PREVIEW): the value held over each step of the horizon."""
    return 0.5 * (nodes[:, 1:] + nodes[:, :-1])


def _control() -> ca.Function:
    """(p, u, x, K) -> (x, y): errors, feedback with the gain K, feed-forward."""
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    x, K = ca.SX.sym("x", STATES.size), ca.SX.sym("K", 2, 4)
    state = STATES.split(x)
    reference = {name: u[f"reference.{name}"] for name in REFERENCE}
    path = inversion.Path(_ahead(u, "speed"), _ahead(u, "curvature"))
    steady = inversion.steady(p, reference["speed"], reference["curvature"])
    z = ca.if_else(state["started"], state["zero_dynamics"], steady)
    velocity = u.vector("estimate.velocity", "xy")
    beta = ca.atan2(velocity[1], ca.fmax(velocity[0], 1.0))
    slow = state["sideslip"]
    e = tracking.path_errors(u.vector("estimate.position", "xy"), u["estimate.yaw"], velocity, reference, z[0] + slow)
    moving = ca.fmin(ca.fmax(reference["speed"] / _MOVING, 0), 1)
    get, q = p.__getitem__, state["yaw_answer"]
    seen = lag.undo(get, e, reference["speed"], moving * (beta - z[0] - slow), q)
    du, integrals = _feedback(p, K, seen, state["integrals"], moving)
    values = _commands(p, z, path, _ahead(u, "acceleration"), du)
    values |= {f"error.{name}": e[i] for i, name in enumerate(_ERRORS)}
    values["error.course"] = tracking.wrap(u["estimate.yaw"] + beta - reference["course"])
    values |= {"feedforward.sideslip": z[0], "feedforward.yaw_rate": z[1]}
    values |= {"feedback.acceleration": du[0], "feedback.yaw_rate": du[1]}
    learnt = slow + (1 - ca.exp(-p["sample_period"] / p["sideslip_time"])) * (beta - z[0] - slow)
    later = inversion.propagate(p, z, path, p["sample_period"], 2)
    after = STATES.join(
        {"started": ca.SX(1), "zero_dynamics": later, "integrals": integrals, "sideslip": learnt}
        | {"yaw_answer": lag.answer(get, q, du[1])}
    )
    return ca.Function("control", [p.column, u.column, x, K], [after, stack(INTERFACE.names("output"), values)])


def _ahead(u: Signals, name: str) -> inversion.Ahead:
    """The near future of a quantity of the reference, as a polynomial of the time ahead."""
    nodes = [u[f"reference.{name}"], *(u[f"preview[{k}].{name}"] for k in range(1, inversion.NODES))]
    return inversion.polynomial(ca.vertcat(*nodes), PREVIEW_PERIOD)


def _feedback(p: Signals, K: ca.SX, e: ca.SX, integrals: ca.SX, moving: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Limited (da, dw) = -K e - integral terms, and the next integrals, frozen at the limit and at rest."""
    gains = ca.vertcat(p["integral.longitudinal"], p["integral.lateral"])
    limits = ca.vertcat(p["limit.acceleration"], p["limit.yaw_rate"])
    wanted = -(K @ e) - gains * integrals
    du = ca.fmin(ca.fmax(wanted, -limits), limits)
    growth = moving * p["sample_period"] * ca.vertcat(e[0], e[2])
    return du, integrals + (du == wanted) * growth


def _commands(p: Signals, z: ca.SX, path: inversion.Path, acceleration: inversion.Ahead, du: ca.SX) -> dict[str, ca.SX]:
    """The commands: the reference taken ahead by the delay of each channel, plus the feedback."""
    early, soon, later = (lead(p.__getitem__) for lead in (leads.steering, leads.yaw_rate, leads.speed))
    z_steer = inversion.propagate(p, z, path, early, 4)
    z_yaw = inversion.propagate(p, z, path, soon, 4)
    return {
        "command.acceleration": acceleration(later) + du[0],
        "command.speed": path.speed(later) + p["speed_gain"] * du[0],
        "command.yaw_rate": z_yaw[1] + du[1],
        "command.steer_feedforward": inversion.steering(p, z_steer, path, early),
    }
