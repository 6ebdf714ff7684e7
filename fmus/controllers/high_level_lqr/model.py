"""HighLevelLqr: from the trajectory bus and the estimate to commands."""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, block, sampled_kernel, slots
from fmus.cars.rotation import wrap
from fmus.clip import clip
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD, REFERENCE
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


def kernel() -> Kernel:
    """The kernel; d holds the terminal weight."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=initialise, sample=sample, symbol=ca.MX)


def initialise(p: Signals) -> tuple[Parts, Parts, Parts]:
    """The terminal weight; nothing is commanded before the first sample."""
    v = p["terminal.speed"]
    return {"terminal": riccati.terminal(_weights(p), v, lag.reach(p, v))}, {}, {}


def sample(p: Signals, d: Parts, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    """The gain of the horizon that begins now, and what is made of it."""
    v, curvature = (_between(_along(u, name)) for name in ("speed", "curvature"))
    K = riccati.first_gain(d["terminal"], _weights(p), v, curvature, lag.reach(p, v))
    after, outputs = control(p, u, x, K)
    return after, outputs


def _weights(p: Signals) -> ca.MX:
    return p.vector("weight", _WEIGHTS)


def _along(u: Signals, name: str) -> Any:
    """One quantity of the reference now and along the preview (1 x PREVIEW + 1)."""
    return u.pick([f"reference.{name}", *(f"preview[{k}].{name}" for k in range(1, PREVIEW + 1))]).T


def _between(nodes: ca.MX) -> ca.MX:
    """Means of neighbours (1 x PREVIEW): the value held over each step of the horizon."""
    return 0.5 * (nodes[:, 1:] + nodes[:, :-1])


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), x=STATES, K=(2, 4))
def control(p: Signals, u: Signals, x: Parts, K: ca.SX) -> tuple[Parts, Parts]:
    """States and outputs of a sample: errors, feedback with the gain K, feed-forward."""
    reference = {name: u[f"reference.{name}"] for name in REFERENCE}
    path = inversion.NearFuture(_ahead(u, "speed"), _ahead(u, "curvature"))
    steady = inversion.steady(p, reference["speed"], reference["curvature"])
    z = ca.if_else(x["started"], x["zero_dynamics"], steady)
    velocity, q, slow = u.vector("estimate.velocity", "xy"), x["yaw_answer"], x["sideslip"]
    beta = ca.atan2(velocity[1], ca.fmax(velocity[0], 1.0))
    e = tracking.path_errors(u.vector("estimate.position", "xy"), u["estimate.yaw"], velocity, reference, z[0] + slow)
    moving = clip(reference["speed"] / _MOVING, 0, 1)
    seen = lag.undo(p, e, reference["speed"], moving * (beta - z[0] - slow), q)
    du, integrals = _feedback(p, K, seen, x["integrals"], moving)
    outputs = _commands(p, z, path, _ahead(u, "acceleration"), du)
    outputs |= {f"error.{name}": e[i] for i, name in enumerate(_ERRORS)}
    outputs["error.course"] = wrap(u["estimate.yaw"] + beta - reference["course"])
    outputs |= {"feedforward.sideslip": z[0], "feedforward.yaw_rate": z[1]}
    outputs |= {"feedback.acceleration": du[0], "feedback.yaw_rate": du[1]}
    after = {
        "started": ca.SX(1),
        "zero_dynamics": inversion.propagate(p, z, path, p["sample_period"], 2),
        "integrals": integrals,
        "yaw_answer": lag.answer(p, q, du[1]),
        "sideslip": slow + (1 - ca.exp(-p["sample_period"] / p["sideslip_time"])) * (beta - z[0] - slow),
    }
    return after, outputs


def _ahead(u: Signals, name: str) -> inversion.Ahead:
    """The near future of a quantity of the reference, as a polynomial of the time ahead."""
    return inversion.polynomial(_along(u, name)[: inversion.NODES].T, PREVIEW_PERIOD)


def _feedback(p: Signals, K: ca.SX, e: ca.SX, integrals: ca.SX, moving: ca.SX) -> tuple[ca.SX, ca.SX]:
    """Limited (da, dw) = -K e - integral terms, and the next integrals, frozen at the limit and at rest."""
    gains = ca.vertcat(p["integral.longitudinal"], p["integral.lateral"])
    limits = ca.vertcat(p["limit.acceleration"], p["limit.yaw_rate"])
    wanted = -(K @ e) - gains * integrals
    du = clip(wanted, -limits, limits)
    growth = moving * p["sample_period"] * ca.vertcat(e[0], e[2])
    return du, integrals + (du == wanted) * growth


def _commands(p: Signals, z: ca.SX, path: inversion.NearFuture, acceleration: inversion.Ahead, du: ca.SX) -> Parts:
    """The commands: the reference taken ahead by the delay of each channel, plus the feedback."""
    early, soon, later = (lead(p) for lead in (leads.steering, leads.yaw_rate, leads.speed))
    z_steer = inversion.propagate(p, z, path, early, 4)
    z_yaw = inversion.propagate(p, z, path, soon, 4)
    return {
        "command.acceleration": acceleration(later) + du[0],
        "command.speed": path.speed(later) + p["speed_gain"] * du[0],
        "command.yaw_rate": z_yaw[1] + du[1],
        "command.steer_feedforward": inversion.steering(p, z_steer, path, early),
    }
