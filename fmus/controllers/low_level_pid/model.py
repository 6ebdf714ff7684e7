"""LowLevelPid: from commands and measurements to actuator torques and forces."""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, choose, named, sampled_kernel
from fmus.cars.wheels import FRONT, WHEELS
from fmus.controllers.low_level_pid import slip, smoothing, speed, steering, suspension, wheels
from fmus.controllers.low_level_pid.interface import INTERFACE

_FILTERS = {
    "speed": "speed",
    "acceleration": "speed",
    "yaw_rate": "yaw_rate",
    "steer_feedforward": "steering",
    "heave": "suspension",
    "roll": "suspension",
    "pitch": "suspension",
}
"""Which `filter.*` each command goes through."""
STATES = Layout(
    started=1,  # 0 before the first sample, which starts the filters at the first command
    filters=Layout(**dict.fromkeys(_FILTERS, 3)),
    speed_integral=1,
    wheels=wheels.STATES,
    unequal=2,  # difference of what the brakes left and right were released, front and rear
    yaw_integral=1,
    steer_angle=1,
    steer_integral=2,
    attitude_integral=3,
    suspension_force=4,
)
DERIVED = Layout(transitions=Layout(**dict.fromkeys(_FILTERS.values(), 9)), sharing=12, lag=1)


def kernel() -> Kernel:
    """The kernel; d holds the exact transitions of the filters and the sharing of the suspension forces."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=initialise, sample=sample)


def initialise(p: Signals) -> tuple[Parts, Parts, Parts]:
    """Nothing is commanded before the first sample."""
    T = p["sample_period"]
    transitions = {name: ca.vec(smoothing.transition(p[f"filter.{name}"], T)) for name in _FILTERS.values()}
    lag = ca.exp(-T / p["suspension.lag"])
    return {"transitions": transitions, "sharing": ca.vec(suspension.sharing(p)), "lag": lag}, {}, {}


def sample(p: Signals, d: Parts, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    """Smooth commands, then the loops of speed, steering and suspension."""
    command = {name: u[f"command.{name}"] for name in _FILTERS}
    settled = {name: smoothing.settled(value) for name, value in command.items()}
    smooth = choose(x["started"], x["filters"], settled)
    drive, standing, drive_next = _drive(p, u, x, smooth)
    steer, steer_next = _steer(p, u, x, smooth, standing)
    lift, lift_next = _lift(p, d, u, x, smooth)
    filters = {
        name: smoothing.advance(ca.reshape(d["transitions"][rate], 3, 3), smooth[name], command[name])
        for name, rate in _FILTERS.items()
    }
    outputs = {
        **drive,
        **steer,
        **lift,
        **{f"filtered.{name}": smooth[name][0] for name in ("speed", "acceleration", "yaw_rate")},
    }
    return {"started": ca.SX(1), "filters": filters, **drive_next, **steer_next, **lift_next}, outputs


def _drive(p: Signals, u: Signals, x: Parts, command: Parts) -> tuple[Parts, ca.SX, Parts]:
    """Outputs: torques of the speed loop or commanded, within what the wheels bear; standing 0/1; next states."""
    v = u["estimate.velocity.x"]
    closed = speed.drive(p, v, command["speed"][0], command["acceleration"][0], x["speed_integral"])
    wanted = speed.or_fed_through(
        p, closed, *(u.vector(f"command.{kind}_torque", WHEELS) for kind in ("wheel", "brake"))
    )
    found = wheels.observe(p, u, x["wheels"], x["started"], wanted)
    given, unequal = slip.balanced(p, slip.limit(p, found, wanted.wheel_torque, wanted.brake_torque), x["unequal"])
    limited = ca.mmax(given.limited)
    outputs = {
        **named("wheel_torque", WHEELS, given.motor),
        **named("brake_torque", WHEELS, given.brake),
        **named("saturation.wheel", WHEELS, given.limited),
        "saturation.drive": ca.fmax(wanted.saturated, limited),
    }
    integral = (
        (1 - wanted.standing) * (1 - p["speed.fed_through"]) * (x["speed_integral"] + (1 - limited) * wanted.growth)
    )
    states = {
        "speed_integral": integral,
        "wheels": wheels.kept(found, found.direction * given.motor - given.brake),
        "unequal": unequal,
    }
    return outputs, wanted.standing, states


def _steer(p: Signals, u: Signals, x: Parts, command: Parts, standing: ca.SX) -> tuple[Parts, Parts]:
    """Outputs and next states of the yaw rate loop and the servos."""
    v, yaw_rate = u["estimate.velocity.x"], u["estimate.yaw_rate"]
    feedforward = ca.if_else(p["yaw.fed_through"], u["command.steer_angle"], command["steer_feedforward"][0])
    angle = ca.if_else(x["started"], x["steer_angle"], feedforward)
    error = command["yaw_rate"][0] - yaw_rate
    demand = steering.demand(p, v, feedforward, error, (angle, x["yaw_integral"]))
    angles, slopes = steering.ackermann(angle, p["design.track"] / 2, p["design.l_f"] + p["design.l_r"])
    measured = (u.vector("steer_angle", FRONT), u.vector("steer_rate", FRONT))
    force = steering.front_force(p, v, yaw_rate)
    torque, integral, saturated = steering.servo(
        p, (angles, slopes * demand.rate), measured, x["steer_integral"], force
    )
    outputs = named("steer_torque", FRONT, torque)
    outputs |= {"steer_demand": angle, "saturation.steering": ca.fmax(saturated, demand.limited)}
    yaw_integral = (1 - standing) * demand.integral
    return outputs, {"yaw_integral": yaw_integral, "steer_angle": demand.angle, "steer_integral": integral}


def _lift(p: Signals, d: Parts, u: Signals, x: Parts, command: Parts) -> tuple[Parts, Parts]:
    """Outputs and next states of the active suspension; heave comes from the suspension travel."""
    T_plus: Any = ca.reshape(d["sharing"], 4, 3)
    heave = -(T_plus[:, 0].T @ u.vector("suspension_travel", WHEELS))
    heave_rate = -(T_plus[:, 0].T @ u.vector("suspension_rate", WHEELS))
    wanted, wanted_rate = (ca.vertcat(*(command[n][i] for n in ("heave", "roll", "pitch"))) for i in (0, 1))
    error = wanted - ca.vertcat(heave, u["estimate.roll"], u["estimate.pitch"])
    rate = wanted_rate - ca.vertcat(heave_rate, u["estimate.roll_rate"], u["estimate.pitch_rate"])
    force, integral, saturated = suspension.forces(p, T_plus, error, rate, x["attitude_integral"])
    lagged = force + d["lag"] * (x["suspension_force"] - force)
    outputs = {**named("suspension_force", WHEELS, lagged), "saturation.suspension": saturated, "heave": heave}
    return outputs, {"attitude_integral": integral, "suspension_force": lagged}
