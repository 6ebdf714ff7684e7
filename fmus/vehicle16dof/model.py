"""Vehicle16Dof: masses, start and outputs; the motion is that of `equations`."""

from __future__ import annotations

import casadi as ca

from fmukit.interface import AXES
from fmukit.kernel import Kernel, Parts, Signals, continuous_kernel, named
from fmus.cars.rotation import angles
from fmus.cars.sideslip import sideslip
from fmus.cars.wheels import FRONT, WHEELS
from fmus.vehicle16dof import energy, start, static_equilibrium
from fmus.vehicle16dof.equations import derivative, evaluate
from fmus.vehicle16dof.interface import INTERFACE
from fmus.vehicle16dof.masses import masses
from fmus.vehicle16dof.states import DERIVED, STATES


def kernel() -> Kernel:
    """The kernel; d holds the mass distribution."""
    return continuous_kernel(
        INTERFACE,
        states=STATES,
        derived=DERIVED,
        initialise=initialise,
        derivative=derivative,
        output=output,
        project=project,
        symbol=ca.MX,
    )


def initialise(p: Signals, u: Signals) -> tuple[Parts, Parts]:
    """Static equilibrium under this load on this road, moving along the yaw direction, wheels rolling without slip."""
    d = masses(p)
    return d, start.rolling(p, u, static_equilibrium.found(p, d, u))


def project(x: Parts) -> Parts:
    """The states with a quaternion of unit length."""
    return x | {"attitude": x["attitude"] / ca.sqrt(ca.sumsqr(x["attitude"]))}


def output(p: Signals, d: Parts, u: Signals, x: Parts) -> Parts:
    """Motion of O1, suspensions, steering, wheels, and the forces on the tyres."""
    seen = evaluate(p, d, u, x)
    roll, pitch, yaw = angles(seen.R)
    a, wheels = seen.accelerations, seen.wheels
    acceleration = a.specific_force + seen.gravity
    return {
        **named("position", AXES, x["position"]),
        "roll": roll,
        "pitch": pitch,
        "yaw": yaw,
        **named("velocity", AXES, x["velocity"]),
        **named("angular_rate", AXES, x["angular_rate"]),
        **named("acceleration", AXES, acceleration),
        **named("specific_force", AXES, a.specific_force),
        **named("angular_acceleration", AXES, a.angular),
        "sideslip": sideslip(x["velocity"][:2]),
        **named("suspension_travel", WHEELS, x["travel"]),
        **named("suspension_rate", WHEELS, x["travel_rate"]),
        **named("steer_angle", FRONT, x["steer"]),
        **named("steer_rate", FRONT, x["steer_rate"]),
        **named("wheel_angle", WHEELS, x["wheel_angle"]),
        **named("wheel_speed", WHEELS, x["wheel_speed"]),
        **named("tyre_force_x", WHEELS, [w.tyre.F_x for w in wheels]),
        **named("tyre_force_y", WHEELS, [w.tyre.F_y for w in wheels]),
        **named("tyre_force_z", WHEELS, [w.contact.F_z for w in wheels]),
        **named("slip_ratio", WHEELS, x["slip_ratio"]),
        **named("slip_angle", WHEELS, ca.atan(x["slip_tangent"])),
        **{f"energy.{name}": value for name, value in energy.energies(p, d, x, seen).items()},
        **{f"power.{name}": value for name, value in energy.powers(p, u, x, seen).items()},
    }
