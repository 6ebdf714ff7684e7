"""DoubleTrack: start and outputs; the motion is that of `dynamics`."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Parts, Signals, continuous_kernel, named
from fmus.cars.rotation import wrap
from fmus.cars.sideslip import sideslip
from fmus.cars.wheels import FRONT, WHEELS
from fmus.double_track.dynamics import STATES, derivative, evaluate
from fmus.double_track.interface import INTERFACE


def kernel() -> Kernel:
    """The kernel; nothing is derived from the parameters."""
    return continuous_kernel(INTERFACE, states=STATES, initialise=initialise, derivative=derivative, output=output)


def initialise(p: Signals) -> tuple[Parts, Parts]:
    """Moving straight ahead, wheels straight, loads static."""
    velocity = ca.vertcat(p["initial.speed"], 0)
    return {}, {"position": p.vector("initial.position", "xy"), "yaw": p["initial.yaw"], "velocity": velocity}


def output(p: Signals, u: Signals, x: Parts) -> Parts:
    """Motion of O1, steering, and the forces on the tyres."""
    seen = evaluate(p, u, x)
    flat, v, a = ca.SX(0), x["velocity"], seen.acceleration
    return {
        **named("position", AXES, ca.vertcat(x["position"], p["geometry.cog_height"])),
        "roll": flat,
        "pitch": flat,
        "yaw": wrap(x["yaw"]),
        **named("velocity", AXES, ca.vertcat(v, 0)),
        **named("angular_rate", AXES, ca.vertcat(0, 0, x["yaw_rate"])),
        **named("acceleration", AXES, ca.vertcat(a, 0)),
        **named("specific_force", AXES, ca.vertcat(a, p["gravity"])),
        **named("angular_acceleration", AXES, ca.vertcat(0, 0, seen.yaw_acceleration)),
        "sideslip": sideslip(v),
        **named("steer_angle", FRONT, ca.vertcat(x["steer"], x["steer"])),
        **named("steer_rate", FRONT, ca.vertcat(seen.steer_rate, seen.steer_rate)),
        **named("wheel_speed", WHEELS, seen.V_x * (1 + x["slip"]) / p["wheel.radius"]),
        **named("tyre_force_x", WHEELS, seen.F_x),
        **named("tyre_force_y", WHEELS, seen.F_y),
        **named("tyre_force_z", WHEELS, seen.F_z),
        **named("slip_angle", WHEELS, seen.alpha),
    }
