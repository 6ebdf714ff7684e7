"""Kernel of DoubleTrack: initialise, one RK4 substep, outputs."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Layout, Signals, continuous_kernel, stack, symbols
from fmus.cars.wheels import FRONT, WHEELS
from fmus.double_track.dynamics import STATES, Motion, derivative, evaluate
from fmus.double_track.interface import INTERFACE

_DERIVED = Layout()


def kernel() -> Kernel:
    """The kernel; see `fmukit.kernel.Kernel` for the arguments of its functions."""
    return continuous_kernel(
        INTERFACE,
        states=STATES,
        derived=_DERIVED,
        initialise=_initialise(),
        step=_step(),
        output=output_function(),
    )


def derivative_function() -> ca.Function:
    """f(p, u, x) -> x'."""
    p, u, x = _symbols()
    parts = STATES.split(x)
    rate = derivative(p, parts, evaluate(p, u, parts))
    return ca.Function("derivative", [p.column, u.column, x], [ca.cse(rate)], ["p", "u", "x"], ["x_dot"])


def output_function() -> ca.Function:
    """(p, d, u, x) -> y."""
    p, u, x = _symbols()
    parts = STATES.split(x)
    y = ca.cse(stack(INTERFACE.names("output"), _outputs(p, parts, evaluate(p, u, parts))))
    return ca.Function("output", [p.column, ca.SX.sym("d", 0), u.column, x], [y], ["p", "d", "u", "x"], ["y"])


def _symbols() -> tuple[Signals, Signals, ca.SX]:
    return symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input"), STATES.symbol()


def _step() -> ca.Function:
    """(p, d, u, x, h) -> x after h [s] by Runge-Kutta of order four; calls keep the C code short."""
    f = derivative_function()
    p, u, x = (ca.MX.sym(name, f.numel_in(i)) for i, name in enumerate("pux"))
    d, h = ca.MX.sym("d", 0), ca.MX.sym("h")
    k_1 = f(p, u, x)
    k_2 = f(p, u, x + h / 2 * k_1)
    k_3 = f(p, u, x + h / 2 * k_2)
    k_4 = f(p, u, x + h * k_3)
    after = x + h / 6 * (k_1 + 2 * (k_2 + k_3) + k_4)
    return ca.Function("step", [p, d, u, x, h], [after], ["p", "d", "u", "x", "h"], ["x_next"])


def _initialise() -> ca.Function:
    """(p, u, w, table, rows) -> (d, x, y): moving straight ahead, wheels straight, loads static."""
    p, u, _ = _symbols()
    none, rows = ca.SX.sym("none", 0), ca.SX.sym("rows")
    x = STATES.join(
        {
            "position": p.vector("initial.position", "xy"),
            "yaw": p["initial.yaw"],
            "velocity": ca.vertcat(p["initial.speed"], 0),
            **{name: ca.SX.zeros(size) for name, size in (("yaw_rate", 1), ("steer", 1), ("transfer", 2))},
        }
    )
    d = ca.SX(0, 1)
    y = output_function()(p.column, d, u.column, x)
    arguments = [p.column, u.column, none, ca.SX.sym("table", 0), rows]
    return ca.Function("initialise", arguments, [d, x, y], ["p", "u", "w", "table", "rows"], ["d", "x", "y"])


def _outputs(p: Signals, x: dict[str, ca.SX], motion: Motion) -> dict[str, ca.SX]:
    flat, v, a = ca.SX(0), x["velocity"], motion.acceleration
    return {
        **_named("position", AXES, ca.vertcat(x["position"], p["geometry.cog_height"])),
        "roll": flat,
        "pitch": flat,
        "yaw": ca.atan2(ca.sin(x["yaw"]), ca.cos(x["yaw"])),
        **_named("velocity", AXES, ca.vertcat(v, 0)),
        **_named("angular_rate", AXES, ca.vertcat(0, 0, x["yaw_rate"])),
        **_named("acceleration", AXES, ca.vertcat(a, 0)),
        **_named("specific_force", AXES, ca.vertcat(a, p["gravity"])),
        **_named("angular_acceleration", AXES, ca.vertcat(0, 0, motion.yaw_acceleration)),
        "sideslip": _sideslip(v),
        **_named("steer_angle", FRONT, ca.vertcat(x["steer"], x["steer"])),
        **_named("steer_rate", FRONT, ca.vertcat(motion.steer_rate, motion.steer_rate)),
        **_named("wheel_speed", WHEELS, motion.V_x / p["wheel.radius"]),
        **_named("tyre_force_x", WHEELS, motion.F_x),
        **_named("tyre_force_y", WHEELS, motion.F_y),
        **_named("tyre_force_z", WHEELS, motion.F_z),
        **_named("slip_angle", WHEELS, motion.alpha),
    }


def _named(name: str, members: tuple[str, ...], values: ca.SX) -> dict[str, ca.SX]:
    return {f"{name}.{member}": value for member, value in zip(members, ca.vertsplit(values), strict=True)}


def _sideslip(v: ca.SX) -> ca.SX:
    """atan2(v_y, v_x), faded to zero below 0.5 m/s, where its direction means nothing."""
    return ca.atan2(v[1], v[0]) * ca.fmin(ca.sumsqr(v) / 0.25, 1)
