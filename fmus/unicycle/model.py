"""Unicycle: start, motion over a substep in closed form, and outputs. Equations in README.md."""

from __future__ import annotations

from math import pi

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Parts, Signals, exact_kernel, named
from fmus.cars.rotation import wrap
from fmus.unicycle.interface import INTERFACE
from fmus.unicycle.motion import FirstOrder, displacement, rate

STATES = Layout(position=2, yaw=1, speed=1, yaw_rate=1)


def kernel() -> Kernel:
    """The kernel; nothing is derived from the parameters."""
    return exact_kernel(INTERFACE, states=STATES, initialise=initialise, step=step, output=output)


def initialise(p: Signals) -> tuple[Parts, Parts]:
    """Moving straight ahead."""
    start = {"position": p.vector("initial.position", "xy"), "yaw": p["initial.yaw"], "speed": p["initial.speed"]}
    return {}, start


def step(p: Signals, u: Signals, x: Parts, h: ca.SX) -> Parts:
    """The states after h [s] with the inputs held."""
    speed, yaw_rate = (FirstOrder(*channel) for channel in channels(p, u, x))
    return {
        "position": x["position"] + displacement(speed, yaw_rate, x["yaw"], h),
        "yaw": within_half_a_turn(x["yaw"] + yaw_rate.integral(h)),
        "speed": speed.value(h),
        "yaw_rate": yaw_rate.value(h),
    }


def output(p: Signals, u: Signals, x: Parts) -> Parts:
    """Pose, velocities and accelerations of O1."""
    flat, v, omega = ca.SX(0), x["speed"], x["yaw_rate"]
    v_dot, omega_dot = (rate(*channel) for channel in channels(p, u, x))
    return {
        **named("position", AXES, ca.vertcat(x["position"], p["geometry.cog_height"])),
        **{"roll": flat, "pitch": flat, "yaw": wrap(x["yaw"]), "sideslip": flat},
        **named("velocity", AXES, ca.vertcat(v, 0, 0)),
        **named("angular_rate", AXES, ca.vertcat(0, 0, omega)),
        **named("acceleration", AXES, ca.vertcat(v_dot, v * omega, 0)),
        **named("specific_force", AXES, ca.vertcat(v_dot, v * omega, p["gravity"])),
        **named("angular_acceleration", AXES, ca.vertcat(0, 0, omega_dot)),
    }


def channels(p: Signals, u: Signals, x: Parts) -> tuple[tuple[ca.SX, ...], tuple[ca.SX, ...]]:
    """(value, command, lag, acceleration of the push) of the speed and of the yaw rate."""
    return (
        (x["speed"], u["command.speed"], p["speed.lag"], u["body_force.x"] / p["body.mass"]),
        (x["yaw_rate"], u["command.yaw_rate"], p["yaw_rate.lag"], u["body_moment.z"] / p["body.inertia.z"]),
    )


def within_half_a_turn(yaw: ca.SX) -> ca.SX:
    """The same direction [rad] in [-pi, pi): a yaw that kept growing would lose digits over a long run."""
    return yaw - 2 * pi * ca.floor((yaw + pi) / (2 * pi))
