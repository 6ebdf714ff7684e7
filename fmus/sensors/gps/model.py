"""GpsReceiver: fixes are taken on their own grid, wait in a queue for the latency, and are then reported."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, symbols
from fmus.cars.rotation import body_to_world
from fmus.sensors.gps.interface import INTERFACE
from fmus.sensors.in_flight import InFlight, good

# longest latency 0.3 s over shortest fix period 0.05 s, and two to spare
FIXES = InFlight(8, position=3, velocity=3, heading=1)
STATES = Layout(correlated=3, **FIXES.sizes)
DERIVED = Layout()


def kernel() -> Kernel:
    """The kernel; x holds the slow error, the queue of fixes under way (newest first) and the last one reported."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x = FIXES.empty() | {"correlated": _position_scale(p) * p["position.correlated_noise"] * w[0:3]}
    arguments = [p.column, u.column, w, ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [ca.SX(0, 1), STATES.join(x), _outputs(x, ca.SX(0))])


def _step() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x, t = STATES.symbol("x"), ca.SX.sym("t")
    drifted = _drift(p, w, STATES.split(x))
    taken = FIXES.take(drifted, _fix(p, u, w, t, drifted["correlated"]), p["fix_period"], t)
    new = FIXES.report(taken, p["latency"], t)
    return ca.Function("step", [p.column, DERIVED.symbol("d"), u.column, x, w, t], [STATES.join(new), _outputs(new, t)])


def _drift(p: Signals, w: ca.SX, x: dict[str, ca.SX]) -> dict[str, ca.SX]:
    """Gauss-Markov error c+ = e^(-T/tau) c + sigma sqrt(1 - e^(-2T/tau)) w."""
    decay = ca.exp(-p["sample_period"] / p["position.correlation_time"])
    sigma = _position_scale(p) * p["position.correlated_noise"]
    return x | {"correlated": decay * x["correlated"] + sigma * ca.sqrt(1 - decay**2) * w[0:3]}


def _fix(p: Signals, u: Signals, w: ca.SX, t: ca.SX, correlated: ca.SX) -> dict[str, ca.SX]:
    """Antenna position p + R l, velocity R (v + omega x l) and yaw, with their errors."""
    R = body_to_world(u["truth.roll"], u["truth.pitch"], u["truth.yaw"])
    lever = p.vector("antenna.position", AXES)
    position = u.vector("truth.position", AXES) + R @ lever
    velocity = R @ (u.vector("truth.velocity", AXES) + ca.cross(u.vector("truth.angular_rate", AXES), lever))
    heading = u["truth.yaw"] + p["heading.noise"] / p["antenna.baseline"] * w[9]
    return {
        "position": position + correlated + _position_scale(p) * p["position.noise"] * w[3:6],
        "velocity": velocity + p["velocity.noise"] * w[6:9],
        "heading": ca.atan2(ca.sin(heading), ca.cos(heading)),
        "taken": t,
        "good": good(p["dropout.probability"], (p["outage.start"], p["outage.duration"]), w[10], t),
    }


def _outputs(x: dict[str, ca.SX], t: ca.SX) -> ca.SX:
    fix = FIXES.newest(x)
    motion = ca.vertcat(fix["position"], fix["velocity"], fix["heading"])
    return ca.vertcat(motion, x["count"], fix["taken"], x["latest"][1], t - fix["taken"])


def _position_scale(p: Signals) -> ca.SX:
    return ca.vertcat(1, 1, p["position.vertical_ratio"])
