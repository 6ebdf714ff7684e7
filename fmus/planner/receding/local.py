"""The local problem as a parametric NLP, and the motion between its nodes: build time only.

Node k lies on gate k and is written in the frame of its gate; node 0 is given. All numbers that change from problem to
problem are parameters, so that one compiled library serves every road, car and place.
"""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmus.planner.receding.layout import (
    AHEAD,
    CAR,
    CONSTANTS,
    HORIZON,
    INPUT_SCALE,
    INPUTS,
    SCALE,
    STATES,
    WEIGHTS,
)
from fmus.planner.shooting import interval
from fmus.single_track import model
from fmus.single_track.data import Car, of

SUBSTEPS = 2


def problem(horizon: int = HORIZON) -> dict[str, Any]:
    """The NLP of `horizon` intervals.

    x: scaled states (7 x N+1), scaled inputs (3 x N), interval lengths (N), lateral slack of nodes 1..N [m] and slack
    of the last speed [m/s]. p: step to the next gate (3 x N), inputs before the first, weights, curvature of the road
    at the last gate, constants of the car. g: gaps (7 x N), course and yaw rate at the last node relative to the road.
    """
    N = horizon
    X, U, T = ca.MX.sym("X", STATES, N + 1), ca.MX.sym("U", INPUTS, N), ca.MX.sym("T", 1, N)
    side, fast = ca.MX.sym("side", 1, N), ca.MX.sym("fast")
    steps, before, weights = ca.MX.sym("steps", 3, N), ca.MX.sym("before", INPUTS), ca.MX.sym("weights", len(WEIGHTS))
    kappa, c = ca.MX.sym("kappa"), ca.MX.sym("c", CONSTANTS)
    slack = ca.vertcat(ca.MX(1, N + 1), ca.horzcat(0, side), ca.horzcat(ca.MX(1, N), fast), ca.MX(STATES - 3, N + 1))
    x, u = ca.diag(ca.DM(SCALE)) @ X + slack, ca.diag(ca.DM(INPUT_SCALE)) @ U
    gaps = _gap().map(N)(x[:, :-1], u, T, x[:, 1:], steps, ca.repmat(c, 1, N))
    changes = U - ca.horzcat(before / ca.DM(INPUT_SCALE), U[:, :-1])
    cost = ca.sum2(T) + weights[0] * ca.sumsqr(changes) + weights[1] * (ca.sumsqr(side) + fast**2)
    last = x[:, -1]
    ends = ca.vertcat(last[3] + last[4], last[5] - kappa * last[2])
    return {
        "x": ca.veccat(X, U, T, side, fast),
        "f": cost,
        "g": ca.vertcat(ca.vec(gaps), ends),
        "p": ca.veccat(steps, before, weights, kappa, c),
    }


def motion() -> ca.Function:
    """AHEAD times (state, input, time since then, constants) -> state (7), acceleration [m/s2], curvature [1/m]."""
    x, u, t, c = ca.MX.sym("x", STATES), ca.MX.sym("u", INPUTS), ca.MX.sym("t"), ca.MX.sym("c", CONSTANTS)
    f = _derivative()
    then = interval(f, SUBSTEPS)(x, u, t, c)
    rate = f(then, u, c)
    one = ca.Function("moved", [x, u, t, c], [ca.vertcat(then, rate[2], (rate[3] + rate[4]) / then[2])])
    columns = [ca.MX.sym("x", STATES, AHEAD), ca.MX.sym("u", INPUTS, AHEAD), ca.MX.sym("t", 1, AHEAD)]
    return ca.Function("motion", [*columns, c], [one.map(AHEAD)(*columns, ca.repmat(c, 1, AHEAD))])


def _derivative() -> ca.Function:
    """f(x, u, c) of the single-track car with its numbers as an argument."""
    x, u, c = ca.SX.sym("x", STATES), ca.SX.sym("u", INPUTS), ca.SX.sym("c", CONSTANTS)
    rate = model.derivative(_car(c), x, u, c[-1])
    return ca.Function("single_track", [x, u, c], [ca.cse(rate)], ["x", "u", "c"], ["x_dot"])


def _car(c: ca.SX) -> Car:
    """The car of the constants; forces act on it, so the wheel radius is of no account."""
    return of({**dict(zip(CAR, ca.vertsplit(c[: len(CAR)]), strict=True)), "wheel.radius": 0.0})


def _gap() -> ca.Function:
    """(x, u, T, next x, step to the next gate, c) -> scaled difference of the end of the interval and the next x."""
    x, u, T, c = ca.MX.sym("x", STATES), ca.MX.sym("u", INPUTS), ca.MX.sym("T"), ca.MX.sym("c", CONSTANTS)
    following, step = ca.MX.sym("next", STATES), ca.MX.sym("step", 3)
    end = interval(_derivative(), SUBSTEPS)(x, u, T, c)
    away, cos, sin = end[:2] - step[:2], ca.cos(step[2]), ca.sin(step[2])
    local = ca.vertcat(
        cos * away[0] + sin * away[1], cos * away[1] - sin * away[0], end[2:4], end[4] - step[2], end[5:]
    )
    return ca.Function("gap", [x, u, T, following, step, c], [(local - following) / ca.DM(SCALE)])
