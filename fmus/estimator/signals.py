"""From the ports to the filter's own quantities and back."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Layout, Parts, Signals, block, named, slots
from fmus.cars.rotation import angle_rates, levelling, rotation_plane, wrap
from fmus.cars.wheels import WHEELS
from fmus.estimator import attitude
from fmus.estimator.correction import FIX, LEVER, TRUST
from fmus.estimator.history import ROW
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import BELIEF, PROCESS, READING, STATE, full, pack

SENSED = Layout(attitude=attitude.STATE, rate=3, level=READING.size, started=1)
"""Attitude filters, and what the previous sample read: body rate and levelled reading."""


@block(p=slots(INTERFACE, "parameter"))
def assumptions(p: Signals) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Process densities (column of PROCESS), trust in fixes (column of TRUST), initial covariance (packed)."""
    process = {
        name: p[f"noise.{name}"] ** 2 for name in ("gyroscope", "gyroscope_bias", "accelerometer", "accelerometer_bias")
    } | {"gps_error": p["noise.gps_correlated"] ** 2, "gps_decay": 1 / p["noise.gps_correlation_time"]}
    trust = {name: p[f"noise.gps_{name}"] ** 2 for name in ("position", "velocity", "heading")}
    trust |= {f"gate_{name}": p[f"gate.{name}"] for name in ("heading", "position")} | {"patience": p["gate.patience"]}
    std = [p[f"initial.std.{n}"] for n in ("yaw", "gyroscope_bias", "position", "velocity", "accelerometer_bias")]
    std.append(p["noise.gps_correlated"])
    variance = ca.vertcat(*(ca.repmat(s**2, n) for s, n in zip(std, STATE.sizes.values(), strict=True)))
    return PROCESS.join(process), TRUST.join(trust), pack(ca.diag(variance))


@block(p=slots(INTERFACE, "parameter"))
def prior(p: Signals) -> tuple[ca.SX, ca.SX]:
    """Belief about the inertial unit at the start, level and without yaw rate, and the column of SENSED."""
    psi, lever = p["initial.yaw"], p.vector("imu.position", "xy")
    position = p.vector("initial.position", "xy") + rotation_plane(psi) @ lever
    mean = {"heading": psi, "position": position, "velocity": ca.vertcat(p["initial.speed"], 0)}
    pair = ca.vertcat(p["initial.std.attitude"] ** 2, 0, p["initial.std.gyroscope_bias"] ** 2)
    angles = attitude.STATE.begun({"roll_covariance": pair, "pitch_covariance": pair})
    return ca.vertcat(STATE.begun(mean), assumptions(p)[2]), SENSED.begun({"attitude": angles})


@block(p=slots(INTERFACE, "parameter"), u=slots(INTERFACE, "input"), sensed=SENSED, t=1)
def sense(p: Signals, u: Signals, sensed: Parts, t: ca.SX) -> tuple[ca.SX, ...]:
    """SENSED, row of the history, time since the previous sample [s], and the fix and its age [s], as columns.

    The row's reading is the mean of this sample's and the previous one's: the interval's mean to second order.
    At the very first sample nothing has passed and the previous reading is this one. Nothing here depends on the
    belief, so that a late fix changes the past only through the belief. The age of the fix is counted from its time
    stamp to the filter's own time t, so that no period has to divide another.
    """
    omega, f = u.vector("gyroscope", AXES), u.vector("accelerometer", AXES)
    started, T = sensed["started"], sensed["started"] * p["sample_period"]
    rate = _mean(omega, sensed["rate"], started)
    seen = attitude.quasi_static(u.vector("suspension_travel", WHEELS), f[0:2], p)
    angles = attitude.step(sensed["attitude"], rate, seen, T, p)
    level, lever = _levelled(angles, omega, f, p)
    row = ROW.join({"reading": _mean(level, sensed["level"], started), "lever": lever})
    new = SENSED.join({"attitude": angles, "rate": omega, "level": level, "started": ca.SX(1)})
    return new, row, T, _fix(u), ca.fmax(t - u["gps.time"], 0)


def _mean(new: ca.SX, old: ca.SX, started: ca.SX) -> ca.SX:
    return ca.if_else(started > 0, 0.5 * (new + old), new)


def _levelled(angles: Parts, omega: ca.SX, f: ca.SX, p: Signals) -> tuple[ca.SX, ca.SX]:
    """READING and the LEVER from the inertial unit to the antenna; z bias of the gyroscope not removed."""
    phi, theta = angles["roll"], angles["pitch"]
    free = omega - ca.vertcat(angles["roll_bias"], angles["pitch_bias"], 0)
    C, arm = levelling(phi, theta), p.vector("antenna.position", AXES) - p.vector("imu.position", AXES)
    psi_dot = angle_rates(phi, theta, free)[2]
    reading = READING.join({"yaw_rate": psi_dot, "acceleration": (C @ f)[0:2]})
    lever = LEVER.join({"offset": (C @ arm)[0:2], "velocity": (C @ ca.cross(free, arm))[0:2]})
    return reading, lever


def _fix(u: Signals) -> ca.SX:
    position, velocity = u.vector("gps.position", "xy"), u.vector("gps.velocity", "xy")
    return FIX.join({"position": position, "velocity": velocity, "heading": u["gps.heading"]})


@block(
    p=slots(INTERFACE, "parameter"),
    u=slots(INTERFACE, "input"),
    belief=BELIEF,
    sensed=SENSED,
    nis=2,
    used=1,
    refused=1,
)
def outputs(p: Signals, u: Signals, belief: Parts, sensed: Parts, nis: ca.SX, used: ca.SX, refused: ca.SX) -> Parts:
    """What is told of the car: its motion, the biases, how sure all is, and what became of the fixes."""
    s, angles = STATE.split(belief["mean"]), sensed["attitude"]
    bias = ca.vertcat(angles["roll_bias"], angles["pitch_bias"], s["gyroscope_bias"])
    return {
        **_motion(s, angles, u.vector("gyroscope", AXES) - bias, p),
        **_spread(full(belief["covariance"]), angles),
        **named("estimate.bias.gyroscope", AXES, bias),
        **named("estimate.bias.accelerometer", "xy", s["accelerometer_bias"]),
        **named("nis", ("heading", "position"), nis),
        "fix.used_count": used,
        "fix.refused_count": refused,
    }


def _motion(s: Parts, angles: Parts, omega: ca.SX, p: Signals) -> Parts:
    """Carried from the inertial unit to O1 as a rigid body; O1 is taken to move horizontally."""
    phi, theta, psi = angles["roll"], angles["pitch"], s["heading"]
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


def _spread(P: ca.SX, angles: Parts) -> Parts:
    names = ("yaw", "position.x", "position.y", "velocity.x", "velocity.y")
    variance = {name: P[i, i] for name, i in zip(names, (0, 2, 3, 4, 5), strict=True)}
    variance |= {name: angles[f"{name}_covariance"][0] for name in ("roll", "pitch")}
    return {f"std.{name}": ca.sqrt(value) for name, value in variance.items()}
