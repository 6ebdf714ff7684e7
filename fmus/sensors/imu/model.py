"""Imu: what an accelerometer and a gyroscope fixed to the body at p report of its true motion."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Parts, Signals, named, sampled_kernel
from fmus.sensors.imu.interface import INTERFACE

BIAS = Layout(gyroscope=3, accelerometer=3)  # [rad/s, m/s2]
PLACE = Layout(velocity=3, carried=3, instant=3, mean=3, since=1, seen=1)
"""Of the sensor's place when its truth last changed: v_p [m/s], omega x v_p + f - a [m/s2], the specific force then and
its mean up to then [m/s2], how long ago that was [s], and 1 once there was a sample."""
_STANDS = 1e-9  # m/s, change of velocity over a period below which that of the truth is none
SCALE = Layout(gyroscope=3, accelerometer=3)  # [1]


def kernel() -> Kernel:
    """The kernel; d holds the scale factors drawn at the start, x the biases and what was seen last."""
    states = Layout(bias=BIAS, place=PLACE)
    return sampled_kernel(INTERFACE, states=states, derived=SCALE, initialise=initialise, sample=sample)


def initialise(p: Signals, u: Signals, w: ca.SX) -> tuple[Parts, Parts, Parts]:
    """Scale factors and turn-on biases as drawn; the first readings have no white noise."""
    draws = ca.vertsplit(w, 3)
    bias = {name: p[f"{name}.turn_on_bias"] * draws[i] for i, name in enumerate(BIAS.sizes)}
    scale = {name: 1 + p[f"{name}.scale_error"] * draws[2 + i] for i, name in enumerate(SCALE.sizes)}
    still = {name: ca.SX.zeros(3) for name in BIAS.sizes}
    return scale, {"bias": bias}, measure(p, at_sensor(p, u), scale, bias, still)


def sample(p: Signals, d: Parts, u: Signals, x: Parts, w: ca.SX) -> tuple[Parts, Parts]:
    """Readings with white noise of density n, n/sqrt(T) w, and biases that walk on by k sqrt(T) w."""
    T, draws, bias = p["sample_period"], ca.vertsplit(w, 3), x["bias"]
    white = {name: p[f"{name}.noise_density"] / ca.sqrt(T) * draws[i] for i, name in enumerate(bias)}
    walked = {name: bias[name] + p[f"{name}.bias_walk"] * ca.sqrt(T) * draws[2 + i] for i, name in enumerate(bias)}
    place = averaged(p, u, x["place"])
    truth = {"gyroscope": u.vector("truth.angular_rate", AXES), "accelerometer": place["mean"]}
    return {"bias": walked, "place": place}, measure(p, truth, d, bias, white)


def measure(p: Signals, truth: Parts, scale: Parts, bias: Parts, white: Parts) -> Parts:
    """The readings: (1 + s) truth + bias + noise, clipped to the range and rounded to the resolution."""
    readings: Parts = {}
    for name, true in truth.items():
        analogue = scale[name] * true + bias[name] + white[name]
        readings |= named(name, AXES, digital(analogue, p[f"{name}.range"], p[f"{name}.resolution"]))
    return readings


def at_sensor(p: Signals, u: Signals) -> Parts:
    """omega [rad/s], and f_p = f + epsilon x p + omega x (omega x p) [m/s2] at the sensor (3 each), at this instant."""
    f, omega = u.vector("truth.specific_force", AXES), u.vector("truth.angular_rate", AXES)
    epsilon, lever = u.vector("truth.angular_acceleration", AXES), p.vector("imu.position", AXES)
    return {"gyroscope": omega, "accelerometer": f + ca.cross(epsilon, lever) + ca.cross(omega, ca.cross(omega, lever))}


def averaged(p: Signals, u: Signals, before: Parts) -> Parts:
    """PLACE now. The mean specific force is exact where forces jump, since it is the change of the velocity v_p:

    v_p = v + omega x p,   f_p = v_p' + omega x v_p + f - a,   mean(f_p) = delta v_p/T + mean of both ends of the rest

    Truth that stays the same although the sensor accelerates is held by a host that exchanges more seldom: then the
    mean is over the time in which it was held, and is told until it changes. The first sample is an instant.
    """
    T, seen, truth = p["sample_period"], before["seen"], at_sensor(p, u)
    f, a, v = (u.vector(f"truth.{name}", AXES) for name in ("specific_force", "acceleration", "velocity"))
    omega, instant = truth["gyroscope"], truth["accelerometer"]
    velocity = v + ca.cross(omega, p.vector("imu.position", AXES))
    now = {"velocity": velocity, "carried": ca.cross(omega, velocity) + f - a, "instant": instant}
    same = ca.norm_inf(ca.vertcat(*(now[name] - before[name] for name in now))) <= 0
    speeds_up = ca.norm_inf(instant - now["carried"]) * T > _STANDS
    held, span = ca.logic_and(seen, ca.logic_and(same, speeds_up)), before["since"] + T
    mean = (velocity - before["velocity"]) / span + 0.5 * (before["carried"] + now["carried"])
    told = ca.if_else(held, before["mean"], ca.if_else(seen, mean, instant))
    return now | {"mean": told, "since": ca.if_else(held, span, 0), "seen": ca.SX(1)}


def digital(value: ca.SX, limit: ca.SX, resolution: ca.SX) -> ca.SX:
    """The multiple of `resolution` nearest to the clipped value; the clipped value itself when `resolution` is 0."""
    clipped = ca.fmax(-limit, ca.fmin(limit, value))
    bit = ca.if_else(resolution > 0, resolution, 1)
    return ca.if_else(resolution > 0, bit * ca.floor(clipped / bit + 0.5), clipped)
