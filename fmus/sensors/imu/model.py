"""Imu: what an accelerometer and a gyroscope fixed to the body at p report of its true motion."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Parts, Signals, named, sampled_kernel
from fmus.sensors.imu.interface import INTERFACE

BIAS = Layout(gyroscope=3, accelerometer=3)  # [rad/s, m/s2]
SCALE = Layout(gyroscope=3, accelerometer=3)  # [1]


def kernel() -> Kernel:
    """The kernel; d holds the scale factors drawn at the start, x the biases."""
    return sampled_kernel(INTERFACE, states=BIAS, derived=SCALE, initialise=initialise, sample=sample)


def initialise(p: Signals, u: Signals, w: ca.SX) -> tuple[Parts, Parts, Parts]:
    """Scale factors and turn-on biases as drawn; the first readings have no white noise."""
    draws = ca.vertsplit(w, 3)
    bias = {name: p[f"{name}.turn_on_bias"] * draws[i] for i, name in enumerate(BIAS.sizes)}
    scale = {name: 1 + p[f"{name}.scale_error"] * draws[2 + i] for i, name in enumerate(SCALE.sizes)}
    return scale, bias, measure(p, u, scale, bias, {name: ca.SX.zeros(3) for name in BIAS.sizes})


def sample(p: Signals, d: Parts, u: Signals, x: Parts, w: ca.SX) -> tuple[Parts, Parts]:
    """Readings with white noise of density n, n/sqrt(T) w, and biases that walk on by k sqrt(T) w."""
    T, draws = p["sample_period"], ca.vertsplit(w, 3)
    white = {name: p[f"{name}.noise_density"] / ca.sqrt(T) * draws[i] for i, name in enumerate(x)}
    walked = {name: x[name] + p[f"{name}.bias_walk"] * ca.sqrt(T) * draws[2 + i] for i, name in enumerate(x)}
    return walked, measure(p, u, d, x, white)


def measure(p: Signals, u: Signals, scale: Parts, bias: Parts, white: Parts) -> Parts:
    """The readings: (1 + s) truth + bias + noise, clipped to the range and rounded to the resolution."""
    readings: Parts = {}
    for name, truth in at_sensor(p, u).items():
        analogue = scale[name] * truth + bias[name] + white[name]
        readings |= named(name, AXES, digital(analogue, p[f"{name}.range"], p[f"{name}.resolution"]))
    return readings


def at_sensor(p: Signals, u: Signals) -> Parts:
    """omega [rad/s], and f_p = f + epsilon x p + omega x (omega x p) [m/s2] at the sensor (3 each)."""
    f, omega = u.vector("truth.specific_force", AXES), u.vector("truth.angular_rate", AXES)
    epsilon, lever = u.vector("truth.angular_acceleration", AXES), p.vector("imu.position", AXES)
    return {"gyroscope": omega, "accelerometer": f + ca.cross(epsilon, lever) + ca.cross(omega, ca.cross(omega, lever))}


def digital(value: ca.SX, limit: ca.SX, resolution: ca.SX) -> ca.SX:
    """The multiple of `resolution` nearest to the clipped value; the clipped value itself when `resolution` is 0."""
    clipped = ca.fmax(-limit, ca.fmin(limit, value))
    bit = ca.if_else(resolution > 0, resolution, 1)
    return ca.if_else(resolution > 0, bit * ca.floor(clipped / bit + 0.5), clipped)
