"""MpcAllocator: from the trajectory bus and the estimate to steering angle and wheel torques."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, sampled_kernel, stack
from fmus.cars.wheels import WHEELS
from fmus.controllers.mpc_allocator import limits, observe, plan, programs, states, tracking_qp
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U
from fmus.controllers.mpc_allocator.programs import parameter
from fmus.controllers.mpc_allocator.states import STATES
from fmus.controllers.mpc_allocator.trajectory import reference

DERIVED = Layout()
Values = dict[str, ca.MX]
_INPUTS = INTERFACE.names("input")
_OUTPUTS = INTERFACE.names("output")
_BUS, _ESTIMATE, _MOTORS = (
    [slot for slot, name in enumerate(_INPUTS) if name.startswith(groups)]
    for groups in (("reference.", "preview["), ("estimate.",), ("motor_available.",))
)
_STANDING = 0.01  # m/s: the estimate of a car this slow need not change
_ABSURD = 1e9  # beyond it a number on an input is no measurement


def kernel() -> Kernel:
    """The kernel; every sample solves the prediction's program, then the distribution's."""
    return sampled_kernel(
        INTERFACE,
        states=STATES,
        derived=DERIVED,
        initialise=_initialise(),
        step=_step(),
        solvers=programs.solvers(),
    )


def _initialise() -> ca.Function:
    arguments = [*_arguments(), ca.MX.sym("w", 0), ca.MX.sym("table", 0), ca.MX.sym("rows")]
    return ca.Function("initialise", arguments, [ca.MX(0, 1), states.start(), ca.MX.zeros(len(_OUTPUTS))])


def _step() -> ca.Function:
    p, u = _arguments()
    d, x = ca.MX.sym("d", 0), ca.MX.sym("x", STATES.size)
    after, y = sample(p, u, STATES.split(x))
    arguments = [p, d, u, x, ca.MX.sym("w", 0), ca.MX.sym("t")]
    return ca.Function("step", arguments, [STATES.join(after), stack(_OUTPUTS, y)])


def _arguments() -> tuple[ca.MX, ca.MX]:
    return ca.MX.sym("p", len(INTERFACE.names("parameter"))), ca.MX.sym("u", len(_INPUTS))


def sample(p: ca.MX, u: ca.MX, x: Values) -> tuple[Values, Values]:
    """States and outputs of one sample."""
    get = parameter(p)
    Ts, timeout = get("sample_period"), get("trajectory.timeout")
    finite = ca.fabs(u) <= _ABSURD
    u = ca.if_else(finite, u, 0)
    routed, sighted, told = (ca.mmin(finite[slots]) for slots in (_BUS, _ESTIMATE, _MOTORS))
    usable = routed * sighted * told
    ref = reference(p, u, x, routed)
    seen, e, near = _observe(p, u, x, ref.nodes[:, 0], (routed, sighted, usable))
    seen["motors"] = ca.if_else(told, u[_MOTORS], x["motors"])
    car, wheels = seen["car"], (x["acceleration"], seen["motors"], x["forces"])
    first, later, step, reach = limits.function()(p, car, *wheels, x["command"], Ts)
    u_r, found, tracking = programs.predict(p, x, ref.nodes, near, seen["disturbance"], (first, later, step))
    fresh = (ref.age <= timeout) * (seen["estimate_age"] <= get("estimate.timeout"))
    good = usable * fresh * ref.known * tracking.good
    braking = 1 - good * (1 - ref.lost)
    before = ca.reshape(x["plan"], N_U, NODES)
    kept, wanted, alone = plan.function()(p, found, good, before, x["alone"], x["command"], car[2], Ts)
    steer = ca.fmin(ca.fmax(wanted[0], first[0, 0]), first[0, 1])
    U, missed, shares = programs.distribute(p, x, wanted, car[6], reach)
    after = {
        **ref.states,
        **seen,
        "forces": U,
        "command": steer,
        "beside": ca.vertcat(steer, limits.sides(U)) - u_r[:, 0],
        "plan": ca.vec(kept),
        "alone": alone,
        "fallbacks": x["fallbacks"] + braking,
        **_starts(tracking, shares),
    }
    y = {
        **_of("wheel_torque", WHEELS, get("design.wheel.radius") * U),
        "command.steer_angle": steer,
        **_of("error", ("longitudinal", "lateral", "speed", "course"), ca.vertcat(e[:3], e[3] + e[4])),
        "demand.force_x": wanted[1] + wanted[2],
        "demand.moment_z": get("design.geometry.half_track") * (wanted[2] - wanted[1]),
        **_of("residual", ("force_x", "force_y", "moment_z"), missed),
        **_of("disturbance", ("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate"), after["disturbance"]),
        **_told("solver", tracking),
        **_told("allocation", shares),
        "fallback.active": braking,
        "fallback.count": after["fallbacks"],
        "estimate.age": seen["estimate_age"],
        "trajectory.age": ref.age,
        "trajectory.delay": after["delay"],
    }
    return after, y | {"solver.status": usable * tracking.status}


def _observe(p: ca.MX, u: ca.MX, x: Values, node: ca.MX, told: tuple[ca.MX, ...]) -> tuple[Values, ca.MX, ca.MX]:
    """States of the car, errors and limited errors; `told`: are the bus, the estimate, all inputs usable.

    Without a usable bus the errors are those before.
    """
    routed, sighted, usable = told
    get = parameter(p)
    estimate, elapsed = u[_ESTIMATE], x["estimate_age"] + get("sample_period")
    moving = ca.sumsqr(ca.vertcat(*(u[_INPUTS.index(f"estimate.velocity.{axis}")] for axis in "xy"))) > _STANDING**2
    new = sighted * (1 - ca.mmin(estimate == x["estimate"]) * moving * x["started"])
    before = (x["car"], x["forces"], x["acceleration"], x["command"], x["disturbance"])
    flags = (new, x["known"] * usable * new, get("sample_period"), elapsed)
    car, e, near, d, acceleration = observe.function()(p, u, node, *before, *flags)
    age = ca.if_else(new, 0, ca.fmin(elapsed, _ABSURD))
    seen = {
        "car": car,
        "known": usable * (age <= get("estimate.timeout")),
        "estimate": ca.if_else(new, estimate, x["estimate"]),
        "estimate_age": age,
        "disturbance": d,
        "acceleration": acceleration,
        "errors": ca.if_else(routed, e, x["errors"]),
    }
    return seen, seen["errors"], ca.if_else(usable, near, 0)


def _starts(tracking: programs.Solved, shares: programs.Solved) -> Values:
    """Where the solvers start at the next sample."""
    return {
        "solution": tracking_qp.moved_on(tracking.x),
        "multipliers": tracking_qp.multipliers_moved_on(tracking.y),
        "penalty": tracking.rho,
        "wheel_multipliers": shares.y,
        "wheel_penalty": shares.rho,
    }


def _told(name: str, solved: programs.Solved) -> Values:
    return {f"{name}.status": solved.status, f"{name}.iterations": solved.iterations, f"{name}.time": solved.time}


def _of(group: str, names: tuple[str, ...], values: ca.MX) -> Values:
    return {f"{group}.{name}": value for name, value in zip(names, ca.vertsplit(values), strict=True)}
