"""Radio: a message is sent every period, is under way for the latency, and may be lost."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Parts, Signals, named, sampled_kernel
from fmus.cars.rotation import wrap
from fmus.sensors.in_flight import InFlight, good
from fmus.sensors.radio.interface import INTERFACE, PLANE

# longest latency 0.5 s over shortest message period 0.02 s, and two to spare
MESSAGES = InFlight(27, position=2, yaw=1, velocity=2, yaw_rate=1)


def kernel() -> Kernel:
    """The kernel; x holds the messages under way (newest first) and the last one received."""
    return sampled_kernel(INTERFACE, states=MESSAGES.states, initialise=initialise, sample=sample)


def initialise() -> tuple[Parts, Parts, Parts]:
    """No message yet."""
    x = MESSAGES.empty()
    return {}, x, outputs(x, ca.SX(0))


def sample(p: Signals, u: Signals, x: Parts, w: ca.SX, t: ca.SX) -> tuple[Parts, Parts]:
    """A message is sent when one is due, and the newest that is through is received."""
    sent = MESSAGES.take(x, message(p, u, w, t), p["message_period"], t)
    new = MESSAGES.report(sent, p["latency"], t)
    return new, outputs(new, t)


def message(p: Signals, u: Signals, w: ca.SX, t: ca.SX) -> Parts:
    """What the sender knows, with the errors of this message."""
    yaw = u["message.yaw"] + p["yaw.noise"] * w[2]
    return {
        "position": u.vector("message.position", PLANE) + p["position.noise"] * w[0:2],
        "yaw": wrap(yaw),
        "velocity": u.vector("message.velocity", PLANE) + p["velocity.noise"] * w[3:5],
        "yaw_rate": u["message.yaw_rate"] + p["yaw_rate.noise"] * w[5],
        "taken": t,
        "good": good(p["loss.probability"], (p["outage.start"], p["outage.duration"]), w[6], t),
    }


def outputs(x: Parts, t: ca.SX) -> Parts:
    """What is received at time t [s]."""
    newest = MESSAGES.newest(x)
    return {
        **named("leader.position", PLANE, newest["position"]),
        "leader.yaw": newest["yaw"],
        **named("leader.velocity", PLANE, newest["velocity"]),
        "leader.yaw_rate": newest["yaw_rate"],
        "leader.age": t - newest["taken"],
        "leader.count": x["count"],
        "leader.valid": x["count"] > 0,
    }
