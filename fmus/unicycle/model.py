"""Kernel of Unicycle: initialise, one substep, outputs."""

from __future__ import annotations

from math import pi

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Signals, continuous_kernel, stack, symbols
from fmus.unicycle.interface import INTERFACE
from fmus.unicycle.motion import FirstOrder, displacement, rate

STATES = Layout(position=2, yaw=1, speed=1, yaw_rate=1)
DERIVED = Layout()


def kernel() -> Kernel:
    """The kernel; see `fmukit.kernel.Kernel` for the arguments of its functions."""
    return continuous_kernel(
        INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step(), output=_output()
    )


def _initialise() -> ca.Function:
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    x = {"position": p.vector("initial.position", "xy"), "yaw": p["initial.yaw"], "speed": p["initial.speed"]}
    x["yaw_rate"] = ca.SX(0)
    arguments = [p.column, u.column, ca.SX.sym("w", 0), ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [ca.SX(0, 1), STATES.join(x), _outputs(p, u, x)])


def _step() -> ca.Function:
    p, u, x = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), STATES.symbol()
    h, now = ca.SX.sym("h"), STATES.split(x)
    speed, yaw_rate = (FirstOrder(*channel) for channel in _channels(p, u, now))
    new = {
        "position": now["position"] + displacement(speed, yaw_rate, now["yaw"], h),
        "yaw": _within_half_a_turn(now["yaw"] + yaw_rate.integral(h)),
        "speed": speed.value(h),
        "yaw_rate": yaw_rate.value(h),
    }
    return ca.Function("step", [p.column, DERIVED.symbol("d"), u.column, x, h], [STATES.join(new)])


def _output() -> ca.Function:
    p, u, x = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), STATES.symbol()
    return ca.Function("output", [p.column, DERIVED.symbol("d"), u.column, x], [_outputs(p, u, STATES.split(x))])


def _channels(p: Signals, u: Signals, x: dict[str, ca.SX]) -> tuple[tuple[ca.SX, ...], tuple[ca.SX, ...]]:
    """(value, command, lag, acceleration of the push) of the speed and of the yaw rate."""
    return (
        (x["speed"], u["command.speed"], p["speed.lag"], u["body_force.x"] / p["body.mass"]),
        (x["yaw_rate"], u["command.yaw_rate"], p["yaw_rate.lag"], u["body_moment.z"] / p["body.inertia.z"]),
    )


def _within_half_a_turn(yaw: ca.SX) -> ca.SX:
    """A yaw that kept growing would lose digits over a long run."""
    return yaw - 2 * pi * ca.floor((yaw + pi) / (2 * pi))


def _outputs(p: Signals, u: Signals, x: dict[str, ca.SX]) -> ca.SX:
    flat, v, omega = ca.SX(0), x["speed"], x["yaw_rate"]
    v_dot, omega_dot = (rate(*channel) for channel in _channels(p, u, x))
    values = {
        **_named("position", ca.vertcat(x["position"], p["geometry.cog_height"])),
        **{"roll": flat, "pitch": flat, "yaw": ca.atan2(ca.sin(x["yaw"]), ca.cos(x["yaw"])), "sideslip": flat},
        **_named("velocity", ca.vertcat(v, 0, 0)),
        **_named("angular_rate", ca.vertcat(0, 0, omega)),
        **_named("acceleration", ca.vertcat(v_dot, v * omega, 0)),
        **_named("specific_force", ca.vertcat(v_dot, v * omega, p["gravity"])),
        **_named("angular_acceleration", ca.vertcat(0, 0, omega_dot)),
    }
    return stack(INTERFACE.names("output"), values)


def _named(name: str, values: ca.SX) -> dict[str, ca.SX]:
    return {f"{name}.{axis}": value for axis, value in zip(AXES, ca.vertsplit(values), strict=True)}
