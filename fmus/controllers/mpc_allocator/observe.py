"""What is known of the car at a sample: its state, its errors on the reference, and the disturbance.

The disturbance d holds rates that the model does not explain, those of the position in the frame of the path. From
sample to sample, with the measured x and what the car's motion x' = f(x, u) + d from the sample before under the forces
then applied would have made of it, x_{k|k-1},

    d <- d + gain (x_k - x_{k|k-1})/T_s,

where T_s is the time since the last estimate.

What is predicted uses the forces the wheels were given, not those wished for: limits do not wind d up.
"""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, Parts, Signals, block, slots
from fmus.cars.rotation import wrap
from fmus.clip import clip
from fmus.controllers.mpc_allocator.design_car import SLOWEST, STANDSTILL, advance, design_car, wheel_rate
from fmus.controllers.mpc_allocator.horizon import NODE
from fmus.controllers.mpc_allocator.interface import INTERFACE
from fmus.controllers.mpc_allocator.linearise import N_X, loading, turned

LARGEST_ERROR = ca.DM([5.0, 2.0, 10.0, 0.5, 0.8, 2.0, 0.6])
"""Errors beyond these (m, m, m/s, rad, rad, rad/s, rad) are taken as these: what is absurd stays solvable."""
LARGEST_STATE = ca.DM([1e9, 1e9, 200.0, 1.6, 1e9, 50.0, 2.0])
LARGEST_DISTURBANCE = ca.DM([2.0, 2.0, 5.0, 1.0, 1.0, 10.0])
THEN = Layout(car=N_X, forces=4, acceleration=2, command=1, disturbance=N_X - 1)
"""States at the sample before: x, wheel forces [N], accelerations [m/s2], steering command [rad], d."""
_OUTLIER = 5.0  # of these: more is a jump of the estimate, nothing to learn from
_SHORTEST = 0.02  # s: in less time an estimate may move as far as in this


@block(
    p=slots(INTERFACE, "parameter"),
    u=slots(INTERFACE, "input"),
    node=len(NODE),
    then=THEN,
    sighted=1,
    learning=1,
    elapsed=1,
)
def observed(
    p: Signals, u: Signals, node: ca.SX, then: Parts, sighted: ca.SX, learning: ca.SX, elapsed: ca.SX
) -> tuple[ca.SX, ...]:
    """x (7), e (7), e within its limits (7), d (6), accelerations (2) at a sample whose reference is at `node`.

    then      THEN
    sighted   0: there is no new estimate, x is what the model makes of the x before
    learning  0: d is kept
    elapsed   time since the last estimate [s]

    e_delta is the error of the angle the steering has by its lag. Last comes what of beta' and omega_z' the motion of
    the car without d does not explain (2), zero where nothing can be learnt.
    """
    car, lag, U, d = design_car(p), p["actuator.steer_lag"], then["forces"], then["disturbance"]
    unexplained = ca.vertcat(turned(d[:2], -node[2]), d[2:], 0)

    def motion(state: ca.SX, _: float) -> ca.SX:
        return wheel_rate(car, state, U, loading(node))[0] + unexplained

    guess = advance(motion, then["car"], then["command"], lag, p["sample_period"])
    x = _limited(ca.if_else(sighted, measured(u, guess[6]), guess), LARGEST_STATE)
    moving = clip((x[2] - STANDSTILL) / (SLOWEST - STANDSTILL), 0, 1)
    missed = path_frame(x - guess, node)[:6] / elapsed
    learnt = d + moving * p["integral.gain"] * missed
    jump = ca.fabs(missed) * elapsed / ca.fmax(elapsed, _SHORTEST)
    plausible = ca.mmax(jump / LARGEST_DISTURBANCE) <= _OUTLIER
    d_now = ca.if_else(ca.logic_and(learning, plausible), _limited(learnt, LARGEST_DISTURBANCE), d)
    d_now = ca.if_else(p["integral.gain"] > 0, d_now, 0)
    e = errors(x, node)
    _, acceleration = wheel_rate(car, x, U, then["acceleration"])
    unknown = ca.logic_and(learning, plausible) * (d + missed)[[3, 5]]
    return tuple(ca.cse([x, e, _limited(e, LARGEST_ERROR), moving * d_now, acceleration, unknown]))


def measured(u: Signals, delta: ca.SX) -> ca.SX:
    """x (7) of the estimate, with the steering angle delta [rad]."""
    v = u.vector("estimate.velocity", "xy")
    beta = ca.atan2(v[1], ca.fmax(v[0], STANDSTILL))
    speed = ca.if_else(v[0] >= 0, ca.sqrt(ca.sumsqr(v)), v[0])
    position = u.vector("estimate.position", "xy")
    return ca.vertcat(position, speed, beta, u["estimate.yaw"], u["estimate.yaw_rate"], delta)


def errors(x: ca.SX, node: ca.SX) -> ca.SX:
    """e (7) = (e_s, e_n, e_v, e_beta, e_psi, e_omega, e_delta) of x against the node."""
    wanted = ca.vertcat(node[:2], node[3], node[6], node[2] - node[6], node[7], node[8])
    return path_frame(x - wanted, node)


def path_frame(difference: ca.SX, node: ca.SX) -> ca.SX:
    """A difference of states with its position along and across the path and its yaw angle in (-pi, pi]."""
    return ca.vertcat(turned(difference[:2], node[2]), difference[2:4], wrap(difference[4]), difference[5:])


def _limited(value: ca.SX, limit: ca.DM) -> ca.SX:
    return clip(value, -limit, limit)
