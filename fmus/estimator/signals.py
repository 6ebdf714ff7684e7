"""From the ports to the filter's own quantities and back."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Parts, Signals, block, named, slots
from fmus.cars.rotation import angle_rates, levelling, rotation_plane, wrap
from fmus.cars.wheels import WHEELS
from fmus.estimator import attitude
from fmus.estimator.interface import INTERFACE, REAR
from fmus.estimator.navigation import BELIEF, STATE, full, where
from fmus.estimator.records import TALLY, VERDICT

_LONG = 1.0  # s without a fix that is used in full, of which the filter warns


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"))
def sense(p: Signals, u: Signals) -> Parts:
    """SENSED: what a sample reads. Nothing here depends on the belief."""
    force = u.vector("accelerometer", AXES)
    return {
        "unit": {"rate": u.vector("gyroscope", AXES), "force": force},
        "tilt": attitude.quasi_static(u.vector("suspension_travel", WHEELS), force[0:2], p),
        "speed": p["design.rolling_radius"] * ca.sum1(u.vector("wheel_speed", REAR)) / len(REAR),
    }


@block(
    p=slots(INTERFACE, "parameter"),
    u=slots(INTERFACE, "input"),
    belief=BELIEF,
    verdict=VERDICT,
    tally=TALLY,
    refused_for=1,
)
def outputs(p: Signals, u: Signals, belief: Parts, verdict: Parts, tally: Parts, refused_for: ca.SX) -> Parts:
    """What is told of the car: its motion, the biases, how sure all is, and what became of the fixes."""
    s = STATE.split(belief["mean"])
    return {
        **_motion(s, u.vector("gyroscope", AXES) - s["gyroscope_bias"], p),
        **_spread(full(belief["covariance"])),
        **named("estimate.bias.gyroscope", AXES, s["gyroscope_bias"]),
        **named("estimate.bias.accelerometer", "xy", s["accelerometer_bias"]),
        **named("nis", ("heading", "position", "velocity"), verdict["nis"]),
        "fix.used_count": tally["used"],
        "fix.refused_count": tally["refused"],
        "fix.refused_for": refused_for,
        "fix.refused_long": ca.logic_and(refused_for > _LONG, tally["in_a_row"] > 1),
    }


def _motion(s: Parts, omega: ca.SX, p: Signals) -> Parts:
    """Carried from the inertial unit to O1 as a rigid body; O1 is taken to move horizontally."""
    phi, theta, psi = s["tilt"][0], s["tilt"][1], s["heading"]
    C, arm = levelling(phi, theta), -p.vector("imu.position", AXES)
    position = s["position"] + rotation_plane(psi) @ (C @ arm)[0:2]
    level = s["velocity"] + (C @ ca.cross(omega, arm))[0:2]
    v = C.T @ ca.vertcat(level, 0)
    rates = angle_rates(phi, theta, omega)
    return {
        **named("estimate.position", "xy", position),
        "estimate.yaw": wrap(psi),
        **named("estimate.velocity", "xy", v[:2]),
        "estimate.sideslip": ca.atan2(v[1], ca.fmax(v[0], 1.0)),
        "estimate.roll": phi,
        "estimate.pitch": theta,
        **named("estimate", ("roll_rate", "pitch_rate", "yaw_rate"), rates),
    }


_SPREAD = {
    "yaw": ("heading", 0),
    "position.x": ("position", 0),
    "position.y": ("position", 1),
    "velocity.x": ("velocity", 0),
    "velocity.y": ("velocity", 1),
    "roll": ("tilt", 0),
    "pitch": ("tilt", 1),
}


def _spread(P: ca.SX) -> Parts:
    index = {name: where(part)[k] for name, (part, k) in _SPREAD.items()}
    return {f"std.{name}": ca.sqrt(P[i, i]) for name, i in index.items()}
