"""The local problem as a parametric NLP, and the motion between its nodes: build time only.

Node k lies on gate k and is written in the frame of its gate; node 0 is given. All numbers that change from problem to
problem are parameters, so that one compiled library serves every road, car and place.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca

from fmus.cars import published
from fmus.cars.single_track import SingleTrackCar, single_track_car
from fmus.planner.blocks import Shots, shots, with_derivatives
from fmus.planner.program import Symbols, decided, decision
from fmus.planner.receding.layout import AHEAD, CAR, CONSTANTS, HORIZON, INPUTS, SCALE, STATES, SUBSTEPS, WEIGHTS
from fmus.planner.shooting import interval
from fmus.planner.vehicle import two_wheel_drive
from fmus.single_track import model


@dataclass(frozen=True, slots=True)
class LocalProblem:
    """`nlp` and the options `derivatives` of CasADi's solvers for it."""

    nlp: dict[str, Any]
    derivatives: dict[str, ca.Function]


def problem(horizon: int = HORIZON) -> LocalProblem:
    """The NLP of `horizon` intervals.

    x: scaled states (7 x N+1), scaled inputs (3 x N), interval lengths (N), lateral slack of nodes 1..N [m] and slack
    of the last speed [m/s]. p: step to the next gate (3 x N), inputs before the first, weights, curvature of the road
    at the last gate, constants of the car. g: gaps (7 x N), course and yaw rate at the last node relative to the road.
    """
    N = horizon
    vehicle = replace(two_wheel_drive(published.single_track()), f=_derivative())
    steps, before, weights = ca.MX.sym("steps", 3, N), ca.MX.sym("before", INPUTS), ca.MX.sym("weights", len(WEIGHTS))
    kappa, c = ca.MX.sym("kappa"), ca.MX.sym("c", CONSTANTS)
    S = _softening(N)
    w = ca.MX.sym("w", S.size2())
    s = decision(vehicle, N, N)
    gaps = _softened(shots(vehicle, s, steps, SUBSTEPS, c), s, S, w, [steps, c])
    whole = decided(S @ w, vehicle, N)
    slack = w[S.size1() :]
    changes = whole.U - ca.horzcat(before / ca.DM(vehicle.input_scale), whole.U[:, :-1])
    last = whole.x[:, -1]
    ends = ca.vertcat(last[3] + last[4], last[5] - kappa * last[2])
    nlp = {
        "x": w,
        "f": ca.sum2(whole.T) + weights[0] * ca.sumsqr(changes) + weights[1] * ca.sumsqr(slack),
        "g": ca.vertcat(gaps.gaps, ends),
        "p": ca.veccat(steps, before, weights, kappa, c),
    }
    return LocalProblem(nlp, with_derivatives(nlp, gaps, ends))


def _softening(N: int) -> ca.DM:
    """From all decision variables to those of a problem without slacks: the slacks move lateral positions and speed."""
    count = (STATES * (N + 1)) + (INPUTS + 1) * N
    lateral = [STATES * k + 1 for k in range(1, N + 1)]
    columns = range(count, count + N + 1)
    moves = ca.DM.triplet(
        [*lateral, STATES * N + 2], columns, ca.DM([1 / SCALE[1]] * N + [1 / SCALE[2]]), count, count + N + 1
    )
    return ca.horzcat(ca.DM.eye(count), ca.DM(count, N + 1)) + moves


def _softened(gaps: Shots, s: Symbols, S: ca.DM, w: ca.MX, given: list[ca.MX]) -> Shots:
    """The gaps and their derivatives in w, where the decision variables are S w; both depend on what is `given`."""
    at, mu = S @ w, gaps.weights
    plain = ca.Function("plain", [s.column, *given], [gaps.gaps, gaps.jacobian])
    bent = ca.Function("bent", [s.column, mu, *given], [gaps.hessian])
    value, jacobian = plain(at, *given)
    triangle = bent(at, mu, *given)
    full = triangle + triangle.T - ca.diag(ca.diag(triangle))
    return Shots(value, jacobian @ S, ca.triu(S.T @ full @ S), mu)


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


def _car(c: ca.SX) -> SingleTrackCar:
    """The car of the constants; forces act on it, so the wheel radius is of no account."""
    return single_track_car({**dict(zip(CAR, ca.vertsplit(c[: len(CAR)]), strict=True)), "wheel.radius": 0.0})
