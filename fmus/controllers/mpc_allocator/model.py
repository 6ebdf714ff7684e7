"""MpcAllocator: from the trajectory bus and the estimate to steering angle and wheel torques."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Parts, Signals, named, sampled_kernel
from fmus.cars.wheels import WHEELS
from fmus.clip import clip
from fmus.controllers.mpc_allocator import detection, grip, limits, observe, plan, programs, states, tracking_qp
from fmus.controllers.mpc_allocator.horizon import NODES
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_U
from fmus.controllers.mpc_allocator.states import STATES
from fmus.controllers.mpc_allocator.trajectory import reference

_BUS, _ESTIMATE, _MOTORS, _WHEELS = (
    [name for name in INTERFACE.names("input") if name.startswith(groups)]
    for groups in (("reference.", "preview["), ("estimate.",), ("motor_available.",), ("wheel_speed.",))
)
_STANDING = 0.01  # m/s: the estimate of a car this slow need not change
_ABSURD = 1e9  # beyond it a number on an input is no measurement


def kernel() -> Kernel:
    """The kernel; every sample solves the prediction's program, then the distribution's."""
    return sampled_kernel(
        INTERFACE, states=STATES, initialise=initialise, sample=sample, symbol=ca.MX, solvers=programs.solvers()
    )


def initialise() -> tuple[Parts, Parts, Parts]:
    """Nothing is asked for before the first sample."""
    return {}, states.start(), {}


def sample(p: Signals, u: Signals, x: Parts) -> tuple[Parts, Parts]:
    """States and outputs of one sample."""
    finite = u.over(ca.fabs(u.column) <= _ABSURD)
    u = u.over(ca.if_else(finite.column, u.column, 0))
    routed, sighted, told, felt = (ca.mmin(finite.pick(names)) for names in (_BUS, _ESTIMATE, _MOTORS, _WHEELS))
    usable = routed * sighted * told
    assumed, part = p, grip.applied(p, x["grip"]["friction"])
    p = grip.adapted(assumed, part)
    ref = reference(p, u, x, routed, part)
    seen, e, near, missed = _observe(p, u, x, ref.nodes[:, 0], (routed, sighted, usable))
    then = (x["car"], x["forces"], x["acceleration"])
    seen["grip"] = grip.learnt(assumed, *then, missed, part, x["grip"], usable)
    seen["motors"] = ca.if_else(told, u.vector("motor_available", WHEELS), x["motors"])
    asked = (x["acceleration"], x["forces"], x["detection"])
    seen["detection"], response = detection.detected(p, u, seen["car"], *asked, usable * felt)
    available = seen["motors"] * (1 - seen["detection"]["lost"])
    car, wheels = seen["car"], (x["acceleration"], available, x["forces"])
    first, later, step, reach = limits.limits(p, car, *wheels, x["command"], part)
    u_r, found, tracking = programs.predict(p, x, ref.nodes, near, seen["disturbance"], (first, later, step))
    fresh = (ref.age <= p["trajectory.timeout"]) * (seen["estimate_age"] <= p["estimate.timeout"])
    good = usable * fresh * ref.known * tracking.good
    braking = 1 - good * (1 - ref.lost)
    before = ca.reshape(x["plan"], N_U, NODES)
    kept, wanted, alone = plan.follow(p, found, good, before, x["alone"], x["command"], car[2])
    steer = clip(wanted[0], first[0, 0], first[0, 1])
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
        **named("wheel_torque", WHEELS, p["design.wheel.radius"] * U),
        "command.steer_angle": steer,
        **named("error", ("longitudinal", "lateral", "speed", "course"), ca.vertcat(e[:3], e[3] + e[4])),
        "demand.force_x": wanted[1] + wanted[2],
        "demand.moment_z": p["design.geometry.half_track"] * (wanted[2] - wanted[1]),
        **named("residual", ("force_x", "force_y", "moment_z"), missed),
        **named(
            "disturbance", ("longitudinal", "lateral", "speed", "sideslip", "yaw", "yaw_rate"), after["disturbance"]
        ),
        "friction.counted": part,
        "friction.slow": after["slow"],
        **named("motor_response", WHEELS, response),
        **named("motor_lost", WHEELS, available < 1),
        **_told("solver", tracking),
        **_told("allocation", shares),
        "fallback.active": braking,
        "fallback.count": after["fallbacks"],
        "estimate.age": seen["estimate_age"],
        "trajectory.age": ref.age,
        "trajectory.delay": after["delay"],
    }
    return after, y | {"solver.status": usable * tracking.status}


def _observe(
    p: Signals, u: Signals, x: Parts, node: ca.MX, told: tuple[ca.MX, ...]
) -> tuple[Parts, ca.MX, ca.MX, ca.MX]:
    """States of the car, errors, limited errors, and what the model missed of beta' and omega_z'.

    `told`: are the bus, the estimate, all inputs usable. Without a usable bus the errors are those before.
    """
    routed, sighted, usable = told
    estimate, elapsed = u.pick(_ESTIMATE), x["estimate_age"] + p["sample_period"]
    moving = ca.sumsqr(u.vector("estimate.velocity", "xy")) > _STANDING**2
    new = sighted * (1 - ca.mmin(estimate == x["estimate"]) * moving * x["started"])
    then = {name: x[name] for name in observe.THEN.sizes}
    car, e, near, d, acceleration, missed = observe.observed(p, u, node, then, new, x["known"] * usable * new, elapsed)
    age = ca.if_else(new, 0, ca.fmin(elapsed, _ABSURD))
    seen = {
        "car": car,
        "known": usable * (age <= p["estimate.timeout"]),
        "estimate": ca.if_else(new, estimate, x["estimate"]),
        "estimate_age": age,
        "disturbance": d,
        "acceleration": acceleration,
        "errors": ca.if_else(routed, e, x["errors"]),
    }
    return seen, seen["errors"], ca.if_else(usable, near, 0), missed


def _starts(tracking: programs.Solved, shares: programs.Solved) -> Parts:
    """Where the solvers start at the next sample."""
    return {
        "solution": tracking_qp.moved_on(tracking.x),
        "multipliers": tracking_qp.multipliers_moved_on(tracking.y),
        "penalty": tracking.rho,
        "wheel_multipliers": shares.y,
        "wheel_penalty": shares.rho,
    }


def _told(name: str, solved: programs.Solved) -> Parts:
    return {f"{name}.status": solved.status, f"{name}.iterations": solved.iterations, f"{name}.time": solved.time}
