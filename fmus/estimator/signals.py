"""From the ports to the filter's own quantities and back. SX functions called by model.py."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Layout, Signals, stack, symbols
from fmus.cars.rotation import angle_rates, levelling, rotation_plane
from fmus.cars.wheels import WHEELS
from fmus.estimator import attitude
from fmus.estimator.correction import FIX, LEVER, TRUST
from fmus.estimator.history import ROW
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import BELIEF, PROCESS, READING, STATE, pack, unpack

SENSED = Layout(attitude=attitude.STATE.size, rate=3, level=READING.size, started=1)
"""Attitude filters, and what the previous sample read: body rate and levelled reading."""


def assumptions() -> ca.Function:
    """p -> process densities, trust in fixes, initial covariance (packed)."""
    p = symbols(INTERFACE, "parameter")
    process = {
        name: p[f"noise.{name}"] ** 2 for name in ("gyroscope", "gyroscope_bias", "accelerometer", "accelerometer_bias")
    } | {"gps_error": p["noise.gps_correlated"] ** 2, "gps_decay": 1 / p["noise.gps_correlation_time"]}
    trust = {name: p[f"noise.gps_{name}"] ** 2 for name in ("position", "velocity", "heading")}
    trust |= {f"gate_{name}": p[f"gate.{name}"] for name in ("heading", "position")} | {"patience": p["gate.patience"]}
    std = [p[f"initial.std.{n}"] for n in ("yaw", "gyroscope_bias", "position", "velocity", "accelerometer_bias")]
    std.append(p["noise.gps_correlated"])
    variance = ca.vertcat(*(ca.repmat(s**2, n) for s, n in zip(std, STATE.sizes.values(), strict=True)))
    initial = pack(ca.diag(variance))
    return ca.Function("assumptions", [p.column], [PROCESS.join(process), TRUST.join(trust), initial])


def prior() -> ca.Function:
    """p -> belief about the inertial unit at start, level and without yaw rate, and SENSED."""
    p = symbols(INTERFACE, "parameter")
    psi, lever = p["initial.yaw"], p.vector("imu.position", "xy")
    mean = {name: ca.SX.zeros(size) for name, size in STATE.sizes.items()}
    mean |= {"heading": psi, "velocity": ca.vertcat(p["initial.speed"], 0)}
    mean["position"] = p.vector("initial.position", "xy") + rotation_plane(psi) @ lever
    pair = ca.vertcat(p["initial.std.attitude"] ** 2, 0, p["initial.std.gyroscope_bias"] ** 2)
    angles = {name: ca.SX.zeros(size) for name, size in attitude.STATE.sizes.items()}
    angles |= {"roll_covariance": pair, "pitch_covariance": pair}
    sensed = {name: ca.SX.zeros(size) for name, size in SENSED.sizes.items()}
    sensed["attitude"] = attitude.STATE.join(angles)
    belief = ca.vertcat(STATE.join(mean), assumptions()(p.column)[2])
    return ca.Function("prior", [p.column], [belief, SENSED.join(sensed)])


def sense() -> ca.Function:
    """(p, u, sensed, t) -> sensed, row of the history, time since the previous sample, period, and the fix and its age.

    The row's reading is the mean of this sample's and the previous one's: the interval's mean to second order.
    At the very first sample nothing has passed and the previous reading is this one. Nothing here depends on the
    belief, so that a late fix changes the past only through the belief. The age of the fix is counted from its time
    stamp to the filter's own time t, so that no period has to divide another.
    """
    p, u, old, t = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), SENSED.symbol(), ca.SX.sym("t")
    x = SENSED.split(old)
    omega, f = u.vector("gyroscope", AXES), u.vector("accelerometer", AXES)
    started, T = x["started"], x["started"] * p["sample_period"]
    rate = _mean(omega, x["rate"], started)
    travel = {wheel: u[f"suspension_travel.{wheel}"] for wheel in WHEELS}
    seen = attitude.quasi_static(travel, f[0:2], p)
    angles = attitude.step(attitude.STATE.split(x["attitude"]), rate, seen, T, p)
    level, lever = _levelled(angles, omega, f, p)
    row = ROW.join({"reading": _mean(level, x["level"], started), "lever": lever})
    new = {"attitude": attitude.STATE.join(angles), "rate": omega, "level": level, "started": ca.SX(1)}
    age = ca.fmax(t - u["gps.time"], 0)
    outcome = [SENSED.join(new), row, T, p["sample_period"], _fix(u), age, u["gps.fix_count"], u["gps.valid"]]
    return ca.Function("sense", [p.column, u.column, old, t], outcome)


def _mean(new: ca.SX, old: ca.SX, started: ca.SX) -> ca.SX:
    return ca.if_else(started > 0, 0.5 * (new + old), new)


def _levelled(angles: dict[str, ca.SX], omega: ca.SX, f: ca.SX, p: Signals) -> tuple[ca.SX, ca.SX]:
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


def outputs() -> ca.Function:
    """(p, u, belief, sensed, nis, used, refused) -> y."""
    p, u, belief, sensed = (
        symbols(INTERFACE, "parameter"),
        symbols(INTERFACE, "input"),
        BELIEF.symbol(),
        SENSED.symbol(),
    )
    nis, used, refused = ca.SX.sym("nis", 2), ca.SX.sym("used"), ca.SX.sym("refused")
    z, P = unpack(belief)
    s, angles = STATE.split(z), attitude.STATE.split(SENSED.split(sensed)["attitude"])
    bias = ca.vertcat(angles["roll_bias"], angles["pitch_bias"], s["gyroscope_bias"])
    values = _motion(s, angles, u.vector("gyroscope", AXES) - bias, p) | _spread(P, angles)
    values |= {f"estimate.bias.gyroscope.{axis}": bias[i] for i, axis in enumerate(AXES)}
    values |= {f"estimate.bias.accelerometer.{axis}": s["accelerometer_bias"][i] for i, axis in enumerate("xy")}
    values |= {"nis.heading": nis[0], "nis.position": nis[1], "fix.used_count": used, "fix.refused_count": refused}
    y = stack(INTERFACE.names("output"), values)
    return ca.Function("outputs", [p.column, u.column, belief, sensed, nis, used, refused], [y])


def _motion(s: dict[str, ca.SX], angles: dict[str, ca.SX], omega: ca.SX, p: Signals) -> dict[str, ca.SX]:
    """Carried from the inertial unit to O1 as a rigid body; O1 is taken to move horizontally."""
    phi, theta, psi = angles["roll"], angles["pitch"], s["heading"]
    C, arm = levelling(phi, theta), -p.vector("imu.position", AXES)
    position = s["position"] + rotation_plane(psi) @ (C @ arm)[0:2]
    level = s["velocity"] + (C @ ca.cross(omega, arm))[0:2]
    v = C.T @ ca.vertcat(level, 0)
    rates = angle_rates(phi, theta, omega)
    return {
        "estimate.position.x": position[0],
        "estimate.position.y": position[1],
        "estimate.yaw": ca.atan2(ca.sin(psi), ca.cos(psi)),
        "estimate.velocity.x": v[0],
        "estimate.velocity.y": v[1],
        "estimate.sideslip": ca.atan2(v[1], ca.fmax(v[0], 1.0)),
        "estimate.roll": phi,
        "estimate.pitch": theta,
        **{f"estimate.{name}_rate": rate for name, rate in zip(("roll", "pitch", "yaw"), rates, strict=True)},
    }


def _spread(P: ca.SX, angles: dict[str, ca.SX]) -> dict[str, ca.SX]:
    names = ("yaw", "position.x", "position.y", "velocity.x", "velocity.y")
    variance = {name: P[i, i] for name, i in zip(names, (0, 2, 3, 4, 5), strict=True)}
    variance |= {name: angles[f"{name}_covariance"][0] for name in ("roll", "pitch")}
    return {f"std.{name}": ca.sqrt(value) for name, value in variance.items()}
