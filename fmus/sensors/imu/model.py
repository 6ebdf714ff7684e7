"""Imu: what an accelerometer and a gyroscope fixed to the body at p report of its true motion."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, symbols
from fmus.sensors.imu.interface import INTERFACE

STATES = Layout(gyroscope_bias=3, accelerometer_bias=3)
DERIVED = Layout(gyroscope_scale=3, accelerometer_scale=3)
_DEVICES = ("gyroscope", "accelerometer")


def kernel() -> Kernel:
    """The kernel; d holds the scale factors drawn at start, x the biases."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    draws = ca.vertsplit(w, 3)
    x = {f"{name}_bias": p[f"{name}.turn_on_bias"] * draws[i] for i, name in enumerate(_DEVICES)}
    d = {f"{name}_scale": 1 + p[f"{name}.scale_error"] * draws[2 + i] for i, name in enumerate(_DEVICES)}
    y = _measure(p, d, x, _truth(p, u), {name: ca.SX.zeros(3) for name in _DEVICES})
    arguments = [p.column, u.column, w, ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [DERIVED.join(d), STATES.join(x), y])


def _step() -> ca.Function:
    p, u, w = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), ca.SX.sym("w", INTERFACE.noise)
    d, x, t = DERIVED.symbol("d"), STATES.symbol("x"), ca.SX.sym("t")
    T, draws, bias = p["sample_period"], ca.vertsplit(w, 3), STATES.split(x)
    white = {name: p[f"{name}.noise_density"] / ca.sqrt(T) * draws[i] for i, name in enumerate(_DEVICES)}
    y = _measure(p, DERIVED.split(d), bias, _truth(p, u), white)
    walked = {
        f"{name}_bias": bias[f"{name}_bias"] + p[f"{name}.bias_walk"] * ca.sqrt(T) * draws[2 + i]
        for i, name in enumerate(_DEVICES)
    }
    return ca.Function("step", [p.column, d, u.column, x, w, t], [STATES.join(walked), y])


def _truth(p: Signals, u: Signals) -> dict[str, ca.SX]:
    """omega, and f_p = f + epsilon x p + omega x (omega x p) at the sensor."""
    f, omega = u.vector("truth.specific_force", AXES), u.vector("truth.angular_rate", AXES)
    epsilon, lever = u.vector("truth.angular_acceleration", AXES), p.vector("imu.position", AXES)
    at_sensor = f + ca.cross(epsilon, lever) + ca.cross(omega, ca.cross(omega, lever))
    return {"gyroscope": omega, "accelerometer": at_sensor}


def _measure(
    p: Signals, scale: dict[str, ca.SX], bias: dict[str, ca.SX], truth: dict[str, ca.SX], white: dict[str, ca.SX]
) -> ca.SX:
    """(1 + s) truth + bias + noise, clipped to the range and rounded to the resolution; accelerometer first."""
    analogue = {name: scale[f"{name}_scale"] * truth[name] + bias[f"{name}_bias"] + white[name] for name in _DEVICES}
    digital = {name: _digitise(analogue[name], p[f"{name}.range"], p[f"{name}.resolution"]) for name in _DEVICES}
    return ca.vertcat(digital["accelerometer"], digital["gyroscope"])


def _digitise(value: ca.SX, limit: ca.SX, resolution: ca.SX) -> ca.SX:
    """The multiple of `resolution` nearest to the clipped value; the clipped value itself when `resolution` is 0."""
    clipped = ca.fmax(-limit, ca.fmin(limit, value))
    bit = ca.if_else(resolution > 0, resolution, 1)
    return ca.if_else(resolution > 0, bit * ca.floor(clipped / bit + 0.5), clipped)
