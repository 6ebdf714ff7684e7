"""GpsReceiver: fixes are taken on their own grid, wait in a queue for the latency, and are then reported."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Parts, Signals, named, sampled_kernel
from fmus.cars.rotation import body_to_world, wrap
from fmus.sensors.gps.interface import INTERFACE
from fmus.sensors.in_flight import InFlight, good

# longest latency 0.3 s over shortest fix period 0.05 s, and two to spare
FIXES = InFlight(8, position=3, velocity=3, heading=1)
STATES = Layout(correlated=3, fixes=FIXES.states)


def kernel() -> Kernel:
    """The kernel; x holds the slow error, the queue of fixes under way (newest first) and the last one reported."""
    return sampled_kernel(INTERFACE, states=STATES, initialise=initialise, sample=sample)


def initialise(p: Signals, w: ca.SX) -> tuple[Parts, Parts, Parts]:
    """No fix yet; the slow error is drawn from its stationary distribution."""
    drawn = position_scale(p) * p["position.correlated_noise"] * w[0:3]
    return {}, {"correlated": drawn, "fixes": FIXES.empty()}, outputs(FIXES.empty(), ca.SX(0))


def sample(p: Signals, u: Signals, x: Parts, w: ca.SX, t: ca.SX) -> tuple[Parts, Parts]:
    """The slow error moves on; a fix is taken when one is due, and the newest that is through is reported."""
    correlated = drift(p, w, x["correlated"])
    taken = FIXES.take(x["fixes"], fix(p, u, w, t, correlated), p["fix_period"], t)
    fixes = FIXES.report(taken, p["latency"], t)
    return {"correlated": correlated, "fixes": fixes}, outputs(fixes, t)


def drift(p: Signals, w: ca.SX, correlated: ca.SX) -> ca.SX:
    """Gauss-Markov error [m] (3): c+ = e^(-T/tau) c + sigma sqrt(1 - e^(-2T/tau)) w."""
    decay = ca.exp(-p["sample_period"] / p["position.correlation_time"])
    sigma = position_scale(p) * p["position.correlated_noise"]
    return decay * correlated + sigma * ca.sqrt(1 - decay**2) * w[0:3]


def fix(p: Signals, u: Signals, w: ca.SX, t: ca.SX, correlated: ca.SX) -> Parts:
    """Antenna position p + R l, velocity R (v + omega x l) and yaw, with their errors."""
    R = body_to_world(u["truth.roll"], u["truth.pitch"], u["truth.yaw"])
    lever = p.vector("antenna.position", AXES)
    position = u.vector("truth.position", AXES) + R @ lever
    velocity = R @ (u.vector("truth.velocity", AXES) + ca.cross(u.vector("truth.angular_rate", AXES), lever))
    heading = u["truth.yaw"] + p["heading.noise"] / p["antenna.baseline"] * w[9]
    return {
        "position": position + correlated + position_scale(p) * p["position.noise"] * w[3:6],
        "velocity": velocity + p["velocity.noise"] * w[6:9],
        "heading": wrap(heading),
        "taken": t,
        "good": good(p["dropout.probability"], (p["outage.start"], p["outage.duration"]), w[10], t),
    }


def outputs(fixes: Parts, t: ca.SX) -> Parts:
    """What is reported at time t [s]."""
    newest = FIXES.newest(fixes)
    return {
        **named("gps.position", AXES, newest["position"]),
        **named("gps.velocity", AXES, newest["velocity"]),
        "gps.heading": newest["heading"],
        "gps.fix_count": fixes["count"],
        "gps.time": newest["taken"],
        "gps.valid": fixes["latest"][1],
        "gps.age": t - newest["taken"],
    }


def position_scale(p: Signals) -> ca.SX:
    """Error of a position along the world's axes (3) relative to that along x."""
    return ca.vertcat(1, 1, p["position.vertical_ratio"])
