"""LowLevelPid: from commands and measurements to actuator torques and forces."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Signals, sampled_kernel, stack, symbols
from fmus.cars.wheels import FRONT, WHEELS
from fmus.controllers.low_level_pid import smoothing, speed, steering, suspension
from fmus.controllers.low_level_pid.interface import INTERFACE

_FILTERS = {
    "speed": "filter.speed",
    "acceleration": "filter.speed",
    "yaw_rate": "filter.yaw_rate",
    "steer_feedforward": "filter.steering",
    "heave": "filter.suspension",
    "roll": "filter.suspension",
    "pitch": "filter.suspension",
}
STATES = Layout(
    started=1,  # 0 before the first sample, which starts the filters at the first command
    filters=3 * len(_FILTERS),
    speed_integral=1,
    yaw_integral=1,
    steer_angle=1,
    steer_integral=2,
    attitude_integral=3,
    suspension_force=4,
)
DERIVED = Layout(transitions=9 * len(set(_FILTERS.values())), sharing=12, lag=1)


def kernel() -> Kernel:
    """The kernel; d holds the exact transitions of the filters and the sharing of the suspension forces."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    T = p["sample_period"]
    rates = dict.fromkeys(_FILTERS.values())
    transitions = ca.vertcat(*(ca.vec(smoothing.transition(p[name], T)) for name in rates))
    lag = ca.exp(-T / p["suspension.lag"])
    d = DERIVED.join({"transitions": transitions, "sharing": ca.vec(suspension.sharing(p)), "lag": lag})
    outputs = ca.SX.zeros(len(INTERFACE.names("output")))
    arguments: list[ca.SX] = [p.column, u.column, ca.SX.sym("w", 0), ca.SX.sym("table", 0), ca.SX.sym("rows")]
    return ca.Function("initialise", arguments, [d, ca.SX.zeros(STATES.size), outputs])


def _step() -> ca.Function:
    p, u = symbols(INTERFACE, "parameter"), symbols(INTERFACE, "input")
    d, x = ca.SX.sym("d", DERIVED.size), ca.SX.sym("x", STATES.size)
    derived, state = DERIVED.split(d), STATES.split(x)
    command, filters = _smooth(derived, state, u)
    v = u["estimate.velocity.x"]
    closed = speed.drive(p, v, command["speed"][0], command["acceleration"][0], state["speed_integral"])
    torques = (u.vector(f"command.{kind}_torque", WHEELS) for kind in ("wheel", "brake"))
    drive = speed.or_fed_through(p, closed, *torques)
    steer, steer_next = _steer(p, u, state, command, drive.standing)
    lift, lift_next = _lift(p, u, derived, state, command)
    values = {
        **_named("wheel_torque", WHEELS, drive.wheel_torque),
        **_named("brake_torque", WHEELS, drive.brake_torque),
        **steer,
        **lift,
        "saturation.drive": drive.saturated,
        "filtered.speed": command["speed"][0],
        "filtered.acceleration": command["acceleration"][0],
        "filtered.yaw_rate": command["yaw_rate"][0],
    }
    after = {"started": ca.SX(1), "filters": filters, "speed_integral": drive.integral, **steer_next, **lift_next}
    arguments: list[ca.SX] = [p.column, d, u.column, x, ca.SX.sym("w", 0), ca.SX.sym("t")]
    return ca.Function("step", arguments, [STATES.join(after), stack(INTERFACE.names("output"), values)])


def _smooth(derived: dict[str, ca.SX], state: dict[str, ca.SX], u: Signals) -> tuple[dict[str, ca.SX], ca.SX]:
    """States (3) of the D/S filters now by name of the command, and all of them one period later."""
    order = list(dict.fromkeys(_FILTERS.values()))
    now, later = {}, []
    for k, (name, rate) in enumerate(_FILTERS.items()):
        command, j = u[f"command.{name}"], order.index(rate)
        Phi = ca.reshape(derived["transitions"][9 * j : 9 * j + 9], 3, 3)
        kept = state["filters"][3 * k : 3 * k + 3]
        now[name] = ca.if_else(state["started"], kept, smoothing.settled(command))
        later.append(smoothing.advance(Phi, now[name], command))
    return now, ca.vertcat(*later)


def _steer(
    p: Signals, u: Signals, state: dict[str, ca.SX], command: dict[str, ca.SX], standing: ca.SX
) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    """Outputs and next states of the yaw rate loop and the servos."""
    v, yaw_rate = u["estimate.velocity.x"], u["estimate.yaw_rate"]
    feedforward = ca.if_else(p["yaw.fed_through"], u["command.steer_angle"], command["steer_feedforward"][0])
    angle = ca.if_else(state["started"], state["steer_angle"], feedforward)
    error = command["yaw_rate"][0] - yaw_rate
    demand = steering.demand(p, v, feedforward, error, (angle, state["yaw_integral"]))
    angles, slopes = steering.ackermann(angle, p["design.track"] / 2, p["design.l_f"] + p["design.l_r"])
    measured = (u.vector("steer_angle", FRONT), u.vector("steer_rate", FRONT))
    force = steering.front_force(p, v, yaw_rate)
    torque, integral, saturated = steering.servo(
        p, (angles, slopes * demand.rate), measured, state["steer_integral"], force
    )
    outputs = _named("steer_torque", FRONT, torque)
    outputs |= {"steer_demand": angle, "saturation.steering": ca.fmax(saturated, demand.limited)}
    yaw_integral = (1 - standing) * demand.integral
    return outputs, {"yaw_integral": yaw_integral, "steer_angle": demand.angle, "steer_integral": integral}


def _lift(
    p: Signals, u: Signals, derived: dict[str, ca.SX], state: dict[str, ca.SX], command: dict[str, ca.SX]
) -> tuple[dict[str, ca.SX], dict[str, ca.SX]]:
    """Outputs and next states of the active suspension; heave comes from the suspension travel."""
    T_plus = ca.reshape(derived["sharing"], 4, 3)
    heave = -(T_plus[:, 0].T @ u.vector("suspension_travel", WHEELS))
    heave_rate = -(T_plus[:, 0].T @ u.vector("suspension_rate", WHEELS))
    wanted, wanted_rate = (ca.vertcat(*(command[n][i] for n in ("heave", "roll", "pitch"))) for i in (0, 1))
    error = wanted - ca.vertcat(heave, u["estimate.roll"], u["estimate.pitch"])
    rate = wanted_rate - ca.vertcat(heave_rate, u["estimate.roll_rate"], u["estimate.pitch_rate"])
    force, integral, saturated = suspension.forces(p, T_plus, error, rate, state["attitude_integral"])
    lagged = force + derived["lag"] * (state["suspension_force"] - force)
    outputs = {**_named("suspension_force", WHEELS, lagged), "saturation.suspension": saturated, "heave": heave}
    return outputs, {"attitude_integral": integral, "suspension_force": lagged}


def _named(group: str, members: tuple[str, ...], column: ca.SX) -> dict[str, ca.SX]:
    return {f"{group}.{member}": column[i] for i, member in enumerate(members)}
