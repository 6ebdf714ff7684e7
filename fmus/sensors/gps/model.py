"""GpsReceiver: fixes are taken on their own grid, wait in a queue for the latency, and are then reported."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Parts, Signals, named, sampled_kernel
from fmus.cars.rotation import body_to_world, wrap
from fmus.sensors.gps.interface import INTERFACE
from fmus.sensors.in_flight import InFlight, good

# longest latency 2 s over shortest fix period 0.05 s, and two to spare
FIXES = InFlight(42, position=3, velocity=3, heading=1, velocity_delay=1, has_velocity=1, scale=1)
STATES = Layout(correlated=3, pending=3, pending_taken=1, fixes=FIXES.states)
"""`pending` is the velocity that waits for the next fix, taken at `pending_taken`."""
_DUE = 1e-7  # s, tolerance when comparing times
_NEVER = -1e9  # s, instant of a velocity that was not taken


def kernel() -> Kernel:
    """The kernel; x holds the slow error, the queue of fixes under way (newest first) and the last one reported."""
    return sampled_kernel(INTERFACE, states=STATES, initialise=initialise, sample=sample)


def initialise(p: Signals, w: ca.SX) -> tuple[Parts, Parts, Parts]:
    """No fix yet; the slow error is drawn from its stationary distribution."""
    drawn = position_scale(p) * p["position.correlated_noise"] * w[0:3]
    x = {"correlated": drawn, "pending_taken": ca.SX(_NEVER), "fixes": FIXES.empty()}
    return {}, x, outputs(p, FIXES.empty(), ca.SX(0))


def sample(p: Signals, u: Signals, x: Parts, w: ca.SX, t: ca.SX) -> tuple[Parts, Parts]:
    """The slow error moves on; a fix is taken when one is due, and the newest that is through is reported."""
    correlated = drift(p, w, x["correlated"])
    pending = wait(p, u, x, t)
    prompt = p["velocity.delay"] <= _DUE
    velocity, when = ca.if_else(prompt, moving(p, u), x["pending"]), ca.if_else(prompt, t, x["pending_taken"])
    taken = FIXES.take(x["fixes"], fix(p, u, w, t, correlated, velocity, when), p["fix_period"], t)
    fixes = FIXES.report(taken, p["latency"], t)
    return pending | {"correlated": correlated, "fixes": fixes}, outputs(p, fixes, t)


def drift(p: Signals, w: ca.SX, correlated: ca.SX) -> ca.SX:
    """Gauss-Markov error [m] (3): c+ = e^(-T/tau) c + sigma sqrt(1 - e^(-2T/tau)) w."""
    decay = ca.exp(-p["sample_period"] / p["position.correlation_time"])
    sigma = position_scale(p) * p["position.correlated_noise"]
    return decay * correlated + sigma * ca.sqrt(1 - decay**2) * w[0:3]


def wait(p: Signals, u: Signals, x: Parts, t: ca.SX) -> Parts:
    """The velocity of the next fix, taken `velocity.delay` before that (at most a fix period)."""
    period, ahead = p["fix_period"], ca.fmin(p["velocity.delay"], p["fix_period"])
    due = ca.floor((t + ahead + _DUE) / period) > ca.floor((t - p["sample_period"] + ahead + _DUE) / period)
    column = ca.if_else(due, ca.vertcat(moving(p, u), t), ca.vertcat(x["pending"], x["pending_taken"]))
    return {"pending": column[0:3], "pending_taken": column[3]}


def moving(p: Signals, u: Signals) -> ca.SX:
    """Velocity of the antenna R (v + omega x l) (3), world frame."""
    R = body_to_world(u["truth.roll"], u["truth.pitch"], u["truth.yaw"])
    spin = ca.cross(u.vector("truth.angular_rate", AXES), p.vector("antenna.position", AXES))
    return R @ (u.vector("truth.velocity", AXES) + spin)


def fix(p: Signals, u: Signals, w: ca.SX, t: ca.SX, correlated: ca.SX, velocity: ca.SX, when: ca.SX) -> Parts:
    """Antenna position p + R l and yaw now, `velocity` as it was at the time `when`, with their errors."""
    R = body_to_world(u["truth.roll"], u["truth.pitch"], u["truth.yaw"])
    position = u.vector("truth.position", AXES) + R @ p.vector("antenna.position", AXES)
    since = t + _DUE - p["degraded.start"]
    poor = ca.logic_and(since >= 0, since < p["degraded.duration"])
    scale = ca.if_else(poor, p["degraded.factor"], 1)
    heading = u["truth.yaw"] + scale * heading_deviation(p) * w[9]
    return {
        "position": position + correlated + scale * position_scale(p) * p["position.noise"] * w[3:6],
        "velocity": velocity + scale * p["velocity.noise"] * w[6:9],
        "heading": wrap(heading),
        "velocity_delay": ca.if_else(when > _NEVER, t - when, 0),
        "has_velocity": when > _NEVER,
        "scale": scale,
        "taken": t,
        "good": good(p["dropout.probability"], (p["outage.start"], p["outage.duration"]), w[10], t),
    }


def heading_deviation(p: Signals) -> ca.SX:
    """Standard deviation of the heading [rad]."""
    return p["heading.noise"] / p["antenna.baseline"]


def outputs(p: Signals, fixes: Parts, t: ca.SX) -> Parts:
    """What is reported at time t [s]."""
    newest = FIXES.newest(fixes)
    scale, some, two = newest["scale"], fixes["count"] > 0, p["antenna.count"] > 1.5
    white = scale * p["position.noise"]
    return {
        **named("gps.position", AXES, newest["position"]),
        **named("gps.velocity", AXES, newest["velocity"]),
        "gps.heading": ca.if_else(two, newest["heading"], 0),
        "gps.fix_count": fixes["count"],
        "gps.time": newest["taken"],
        "gps.velocity_delay": newest["velocity_delay"],
        "gps.valid": fixes["latest"][1],
        "gps.position_valid": some,
        "gps.velocity_valid": newest["has_velocity"],
        "gps.heading_valid": ca.logic_and(some, two),
        "gps.position_accuracy": some * ca.sqrt(white**2 + p["position.correlated_noise"] ** 2),
        "gps.velocity_accuracy": scale * p["velocity.noise"],
        "gps.heading_accuracy": scale * heading_deviation(p),
        "gps.age": t - newest["taken"],
    }


def position_scale(p: Signals) -> ca.SX:
    """Error of a position along the world's axes (3) relative to that along x."""
    return ca.vertcat(1, 1, p["position.vertical_ratio"])
