"""GpsReceiver: fixes are taken on their own grid, wait in a queue for the latency, and are then reported."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, symbols
from fmus.rotation import body_to_world
from fmus.sensors.gps.interface import INTERFACE

IN_FLIGHT = 8  # longest latency 0.3 s over shortest fix period 0.05 s, and one to spare
_NEVER = -1e9  # s, time of a fix that was not taken
_DUE = 1e-7  # s, tolerance when comparing times
FIX = Layout(position=3, velocity=3, heading=1, taken=1, good=1)
STATES = Layout(correlated=3, last_index=1, count=1, reported=FIX.size, latest=2, queue=IN_FLIGHT * FIX.size)
DERIVED = Layout()


def kernel() -> Kernel:
    """The kernel; x holds the slow error, the queue of fixes under way (newest first) and the last one reported."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x = {name: ca.SX.zeros(size) for name, size in STATES.sizes.items()}
    x["correlated"] = _position_scale(p) * p["position.correlated_noise"] * w[0:3]
    nothing = FIX.join({name: ca.SX.zeros(size) for name, size in FIX.sizes.items()} | {"taken": ca.SX(_NEVER)})
    x |= {"last_index": ca.SX(-1), "latest": ca.SX([_NEVER, 0]), "reported": nothing}
    x["queue"] = ca.repmat(nothing, IN_FLIGHT)
    arguments = [p.column, u.column, w, ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [ca.SX(0, 1), STATES.join(x), _outputs(x, ca.SX(0))])


def _step() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    x, t = STATES.symbol("x"), ca.SX.sym("t")
    new = _report(p, _take(p, u, w, t, _drift(p, w, STATES.split(x))), t)
    return ca.Function("step", [p.column, DERIVED.symbol("d"), u.column, x, w, t], [STATES.join(new), _outputs(new, t)])


def _drift(p: Signals, w: ca.SX, x: dict[str, ca.SX]) -> dict[str, ca.SX]:
    """Gauss-Markov error c+ = e^(-T/tau) c + sigma sqrt(1 - e^(-2T/tau)) w."""
    decay = ca.exp(-p["sample_period"] / p["position.correlation_time"])
    sigma = _position_scale(p) * p["position.correlated_noise"]
    return x | {"correlated": decay * x["correlated"] + sigma * ca.sqrt(1 - decay**2) * w[0:3]}


def _take(p: Signals, u: Signals, w: ca.SX, t: ca.SX, x: dict[str, ca.SX]) -> dict[str, ca.SX]:
    """Put a fix at the head of the queue when one is due at t."""
    index = ca.floor((t + _DUE) / p["fix_period"])
    shifted = ca.vertcat(_fix(p, u, w, t, x["correlated"]), x["queue"][: -FIX.size])
    return x | {"queue": ca.if_else(index > x["last_index"], shifted, x["queue"]), "last_index": index}


def _fix(p: Signals, u: Signals, w: ca.SX, t: ca.SX, correlated: ca.SX) -> ca.SX:
    """Antenna position p + R l, velocity R (v + omega x l) and yaw, with their errors."""
    R = body_to_world(u["truth.roll"], u["truth.pitch"], u["truth.yaw"])
    lever = p.vector("antenna.position", AXES)
    position = u.vector("truth.position", AXES) + R @ lever
    velocity = R @ (u.vector("truth.velocity", AXES) + ca.cross(u.vector("truth.angular_rate", AXES), lever))
    heading = u["truth.yaw"] + p["heading.noise"] / p["antenna.baseline"] * w[9]
    fix = {
        "position": position + correlated + _position_scale(p) * p["position.noise"] * w[3:6],
        "velocity": velocity + p["velocity.noise"] * w[6:9],
        "heading": ca.atan2(ca.sin(heading), ca.cos(heading)),
        "taken": t,
        "good": _good(p, w[10], t),
    }
    return FIX.join(fix)


def _good(p: Signals, w: ca.SX, t: ca.SX) -> ca.SX:
    """0 inside the outage and for a share `dropout.probability` of the fixes: Phi(w) is uniform on [0, 1]."""
    since = t + _DUE - p["outage.start"]
    inside = ca.logic_and(since >= 0, since < p["outage.duration"])
    lost = 0.5 * (1 + ca.erf(w / ca.sqrt(2))) < p["dropout.probability"]
    return 1 - ca.logic_or(inside, lost)


def _report(p: Signals, x: dict[str, ca.SX], t: ca.SX) -> dict[str, ca.SX]:
    """Report the newest good fix whose latency has passed; `latest` is (time, goodness) of the newest due one."""
    reported, latest = x["reported"], x["latest"]
    taken = FIX.split(reported)["taken"]
    for column in reversed(ca.vertsplit(x["queue"], FIX.size)):
        fix = FIX.split(column)
        due = ca.logic_and(fix["taken"] + p["latency"] <= t + _DUE, fix["taken"] > latest[0])
        latest = ca.if_else(due, ca.vertcat(fix["taken"], fix["good"]), latest)
        reported = ca.if_else(ca.logic_and(due, fix["good"] > 0.5), column, reported)
    count = x["count"] + (FIX.split(reported)["taken"] > taken)
    return x | {"reported": reported, "latest": latest, "count": count}


def _outputs(x: dict[str, ca.SX], t: ca.SX) -> ca.SX:
    fix = FIX.split(x["reported"])
    taken = ca.if_else(x["count"] > 0, fix["taken"], 0)
    return ca.vertcat(fix["position"], fix["velocity"], fix["heading"], x["count"], taken, x["latest"][1], t - taken)


def _position_scale(p: Signals) -> ca.SX:
    return ca.vertcat(1, 1, p["position.vertical_ratio"])
