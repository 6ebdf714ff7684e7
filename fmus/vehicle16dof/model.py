"""Kernel of Vehicle16Dof: initialise, one RK4 substep, outputs."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Signals, continuous_kernel, stack, symbols
from fmus.cars.rotation import angles
from fmus.cars.wheels import FRONT, WHEELS
from fmus.vehicle16dof import start, static_equilibrium, tree
from fmus.vehicle16dof.equations import Motion, derivative, evaluate
from fmus.vehicle16dof.integration import rk4
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.states import DERIVED, STATES


def kernel() -> Kernel:
    """The kernel; see `fmukit.kernel.Kernel` for the arguments of its functions."""
    p, d, u = (ca.MX.sym(name, size) for name, size in zip("pdu", _sizes(), strict=True))
    return continuous_kernel(
        INTERFACE,
        states=STATES,
        derived=DERIVED,
        initialise=_initialise(p, u),
        step=rk4(derivative_function(), p, d, u),
        output=output_function(),
    )


def derivative_function() -> ca.Function:
    """f(p, d, u, x) -> x'."""
    p, d, u, x = _symbols()
    parts = STATES.split(x)
    rate = derivative(parts, evaluate(p, DERIVED.split(d), u, parts))
    return ca.Function("derivative", [p.column, d, u.column, x], [ca.cse(rate)], ["p", "d", "u", "x"], ["x_dot"])


def output_function() -> ca.Function:
    """(p, d, u, x) -> y."""
    p, d, u, x = _symbols()
    parts = STATES.split(x)
    values = _outputs(parts, evaluate(p, DERIVED.split(d), u, parts))
    y = ca.cse(stack(INTERFACE.names("output"), values))
    return ca.Function("output", [p.column, d, u.column, x], [y], ["p", "d", "u", "x"], ["y"])


def _sizes() -> tuple[int, int, int]:
    return len(INTERFACE.names("parameter")), DERIVED.size, len(INTERFACE.names("input"))


def _symbols() -> tuple[Signals, ca.SX, Signals, ca.SX]:
    return symbols(INTERFACE, "parameter"), DERIVED.symbol("d"), symbols(INTERFACE, "input"), STATES.symbol()


def _initialise(p: ca.MX, u: ca.MX) -> ca.Function:
    """(p, u, w, table, rows) -> (d, x, y): masses, static equilibrium, rolling wheels."""
    p_, _, u_, _ = _symbols()
    rest = ca.SX.sym("rest", 7)
    derived = ca.Function("derived", [p_.column], [DERIVED.join(tree.derived(p_))])
    first = ca.Function("start", [p_.column, u_.column, rest], [start.state(p_, u_, rest)])
    d = derived(p)
    x = first(p, u, static_equilibrium.newton()(p, d, u))
    w, table, rows = ca.MX.sym("w", 0), ca.MX.sym("table", 0), ca.MX.sym("rows")
    y = output_function()(p, d, u, x)
    return ca.Function(
        "initialise", [p, u, w, table, rows], [d, x, y], ["p", "u", "w", "table", "rows"], ["d", "x", "y"]
    )


def _outputs(x: dict[str, ca.SX], motion: Motion) -> dict[str, ca.SX]:
    roll, pitch, yaw = angles(motion.R)
    a, wheels = motion.accelerations, motion.wheels
    acceleration = a.specific_force + motion.gravity
    return {
        **_named("position", AXES, x["position"]),
        "roll": roll,
        "pitch": pitch,
        "yaw": yaw,
        **_named("velocity", AXES, x["velocity"]),
        **_named("angular_rate", AXES, x["angular_rate"]),
        **_named("acceleration", AXES, acceleration),
        **_named("specific_force", AXES, a.specific_force),
        **_named("angular_acceleration", AXES, a.angular),
        "sideslip": _sideslip(x["velocity"]),
        **_named("suspension_travel", WHEELS, x["travel"]),
        **_named("suspension_rate", WHEELS, x["travel_rate"]),
        **_named("steer_angle", FRONT, x["steer"]),
        **_named("steer_rate", FRONT, x["steer_rate"]),
        **_named("wheel_angle", WHEELS, x["wheel_angle"]),
        **_named("wheel_speed", WHEELS, x["wheel_speed"]),
        **_named("tyre_force_x", WHEELS, [w.tyre.F_x for w in wheels]),
        **_named("tyre_force_y", WHEELS, [w.tyre.F_y for w in wheels]),
        **_named("tyre_force_z", WHEELS, [w.contact.F_z for w in wheels]),
        **_named("slip_ratio", WHEELS, x["slip_ratio"]),
        **_named("slip_angle", WHEELS, ca.atan(x["slip_tangent"])),
    }


def _named(name: str, members: tuple[str, ...], values: ca.SX | list[ca.SX]) -> dict[str, ca.SX]:
    column = values if isinstance(values, list) else ca.vertsplit(values)
    return {f"{name}.{member}": value for member, value in zip(members, column, strict=True)}


def _sideslip(v: ca.SX) -> ca.SX:
    """atan2(v_y, v_x), faded to zero below 0.5 m/s, where its direction means nothing."""
    return ca.atan2(v[1], v[0]) * ca.fmin((v[0] * v[0] + v[1] * v[1]) / 0.25, 1)
