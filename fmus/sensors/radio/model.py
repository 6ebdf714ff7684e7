"""Radio: a message is sent every period, is under way for the latency, and may be lost."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, symbols
from fmus.sensors.in_flight import InFlight, good
from fmus.sensors.radio.interface import INTERFACE, PLANE

# longest latency 0.5 s over shortest message period 0.02 s, and two to spare
MESSAGES = InFlight(27, position=2, yaw=1, velocity=2, yaw_rate=1)
STATES = Layout(**MESSAGES.sizes)
DERIVED = Layout()


def kernel() -> Kernel:
    """The kernel; x holds the messages under way (newest first) and the last one received."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x = MESSAGES.empty()
    arguments = [p.column, u.column, w, ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [ca.SX(0, 1), STATES.join(x), _outputs(x, ca.SX(0))])


def _step() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x, t = STATES.symbol("x"), ca.SX.sym("t")
    sent = MESSAGES.take(STATES.split(x), _message(p, u, w, t), p["message_period"], t)
    new = MESSAGES.report(sent, p["latency"], t)
    return ca.Function("step", [p.column, DERIVED.symbol("d"), u.column, x, w, t], [STATES.join(new), _outputs(new, t)])


def _message(p: Signals, u: Signals, w: ca.SX, t: ca.SX) -> dict[str, ca.SX]:
    """What the sender knows, with the errors of this message."""
    yaw = u["message.yaw"] + p["yaw.noise"] * w[2]
    return {
        "position": u.vector("message.position", PLANE) + p["position.noise"] * w[0:2],
        "yaw": ca.atan2(ca.sin(yaw), ca.cos(yaw)),
        "velocity": u.vector("message.velocity", PLANE) + p["velocity.noise"] * w[3:5],
        "yaw_rate": u["message.yaw_rate"] + p["yaw_rate.noise"] * w[5],
        "taken": t,
        "good": good(p["loss.probability"], (p["outage.start"], p["outage.duration"]), w[6], t),
    }


def _outputs(x: dict[str, ca.SX], t: ca.SX) -> ca.SX:
    message = MESSAGES.newest(x)
    motion = ca.vertcat(message["position"], message["yaw"], message["velocity"], message["yaw_rate"])
    return ca.vertcat(motion, t - message["taken"], x["count"], x["count"] > 0)
