"""Last point to steer: the shortest way to a lateral offset, by direct multiple shooting."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cache

import casadi as ca
import numpy as np

from fmus.cars import published
from fmus.cars.single_track import SingleTrackCar
from fmus.planner import compiled
from fmus.planner.blocks import shots, with_derivatives
from fmus.planner.errors import PlanningError
from fmus.planner.evasion.car import Means, input_limits, motion
from fmus.planner.gates import Array
from fmus.planner.program import Nodes, NonlinearProgram, decision, roughness, scaled
from fmus.planner.vehicle import Vehicle, two_wheel_drive

_SUBSTEPS = 2
_SMOOTHING, _HASTE = 1e-4, 1e-3
"""Weights of the changes of the inputs and of the time back, beside the distance in units of 10 m."""
_WITHOUT_EDGE, _WITH_EDGE = (40,), (30, 20)
"""Intervals up to the offset and, on a road with an edge, from there until the car is straight again."""
_BACK = 2.2
"""Guess of the time [s] from the offset until the car is straight again."""
_COURSE = 0.05
"""Largest sideslip and yaw angle [rad] at an obstacle that is hit all the same, so that the car then stops on the road
(engineering choice)."""
_SHORTEST, _LONGEST = 0.05, (8.0, 2.4)
"""Durations [s] of a phase. A longer way back would let the car swing twice, for 1 % of the distance."""
_OPTIONS = {
    "ipopt": {"print_level": 0, "sb": "yes", "mu_strategy": "adaptive", "max_iter": 500, "tol": 1e-6},
    "print_time": False,
    "calc_lam_p": False,
    "error_on_fail": False,
}


@dataclass(frozen=True, slots=True)
class Task:
    """What is asked: from straight driving at `speed` [m/s] on `friction` to the lateral `offset` [m].

    `edge` [m]: lateral position never passed on the way back to straight driving; without one the motion ends at the
    offset, with `straight` at yaw angle 0 there. `within` [m] asks another question: how far to the side, up to the
    offset, the car gets over that distance ahead.
    """

    speed: float
    friction: float
    offset: float
    means: Means
    edge: float | None = None
    straight: bool = False
    within: float | None = None


@dataclass(frozen=True, slots=True)
class LastPoint:
    """`distance` [m] travelled ahead until the `offset` [m] is reached; the motion at its nodes; how it was found."""

    distance: float
    offset: float
    nodes: Nodes
    iterations: int


class Search:
    """The program of one car, compiled once for all tasks with, or without, an edge."""

    def __init__(self, data: SingleTrackCar | None = None, *, edge: bool, compile_: bool = True) -> None:
        data = data or published.single_track()
        self._vehicle = replace(two_wheel_drive(data), f=motion(data))
        self._counts = _WITH_EDGE if edge else _WITHOUT_EDGE
        self._program = _program(self._vehicle, self._counts)
        self._solver = compiled.solver(self._program, _OPTIONS, compile_=compile_)

    def solve(self, task: Task) -> LastPoint:
        """The last point of the task; raises PlanningError when no motion of the car does it."""
        if (task.edge is not None) != (len(self._counts) == 2):
            raise PlanningError("a task with an edge needs a search with one")
        if task.edge is not None and task.offset > task.edge:
            raise PlanningError(
                f"an offset of {task.offset:g} m is beyond the edge of the road, {task.edge:g} m; ask for less"
            )
        lower, upper = self._bounds(task)
        call, limit = self._solver.call, self._program
        x0 = np.clip(limit.pack(self._guess(task)), lower, upper)
        weights = (1.0, 0.0) if task.within is None else (0.0, -1.0)
        found = call(x0=x0, lbx=lower, ubx=upper, lbg=limit.g_lower, ubg=limit.g_upper, p=[task.friction, *weights])
        stats = call.stats()
        if not stats["success"]:
            raise PlanningError(
                f"no motion leads {task.offset:g} m to the side from {task.speed:g} m/s on friction "
                f"{task.friction:g} (IPOPT: {stats['return_status']}); ask for less"
            )
        nodes = limit.unpack(found["x"].full().ravel())
        reached = nodes.x[:2, self._counts[0]]
        return LastPoint(float(reached[0]), float(reached[1]), nodes, int(stats["iter_count"]))

    def _bounds(self, task: Task) -> tuple[Array, Array]:
        v, m, turn = self._vehicle, sum(self._counts), self._counts[0]
        low, high = (np.repeat(bound[:, None], m + 1, axis=1) for bound in (v.lower, v.upper))
        low[:, 0] = high[:, 0] = [0, 0, task.speed, 0, 0, 0, 0]
        if task.within is None:
            low[1, turn] = task.offset
        else:
            low[0, turn] = high[0, turn] = task.within
            high[1, turn] = task.offset
            low[3:5, turn], high[3:5, turn] = -_COURSE, _COURSE
        if task.straight:
            low[4, turn] = high[4, turn] = 0.0
        if task.edge is not None:
            low[1, turn:], high[1, 1:] = task.offset, task.edge
            low[3:, -1] = high[3:, -1] = 0.0
        least, most = input_limits(task.friction, task.means)
        longest = self._shared(np.array(_LONGEST[: len(self._counts)]))
        return scaled(v, low, least, self._shared(_SHORTEST)), scaled(v, high, most, longest)

    def _guess(self, task: Task) -> Nodes:
        """A quadratic way to the side within the grip, a mirrored one back."""
        m, turn = sum(self._counts), self._counts[0]
        T = np.array([np.sqrt(2 * task.offset / (4.0 * task.friction)) + 0.2, _BACK])[: len(self._counts)]
        steps = self._shared(T)
        times = np.concatenate([[0], np.cumsum(steps)])
        tau = np.concatenate([np.linspace(0, 1, turn + 1), np.linspace(1, 2, m - turn + 1)[1:]])
        x = np.zeros((7, m + 1))
        x[0], x[2] = task.speed * times, task.speed
        x[1] = task.offset * np.where(tau < 1, tau**2, 1) + 0.1 * np.maximum(tau - 1, 0)
        return Nodes(x, np.zeros((3, m)), steps)

    def _shared(self, T: Array | float) -> Array:
        """Lengths (m,) [s] of the intervals from the durations of the phases."""
        counts = np.array(self._counts)
        return np.repeat(T / counts, counts)


@cache
def search(*, edge: bool, compile_: bool = True) -> Search:
    """The search of the default car."""
    return Search(edge=edge, compile_=compile_)


def _program(vehicle: Vehicle, counts: tuple[int, ...]) -> NonlinearProgram:
    """Minimise w_x x + w_y y at the end of the first phase, with free durations; the parameters are mu, w_x, w_y.

    The intervals of a phase are equally long.
    """
    m, p = sum(counts), ca.MX.sym("p", 3)
    s = decision(vehicle, m, m)
    gaps = shots(vehicle, s, ca.DM.zeros(3, m), _SUBSTEPS, p[0])
    phases = ca.horzsplit(s.T, [0, *np.cumsum(counts).tolist()])
    equal = ca.horzcat(*(T[1:] - T[:-1] for T in phases))
    cost = ca.dot(p[1:], s.X[:2, counts[0]]) + _SMOOTHING * roughness(s)
    if len(counts) == 2:
        cost += _HASTE * ca.sum2(phases[1])
    nlp = {"x": s.column, "f": cost, "g": ca.vertcat(gaps.gaps, equal.T), "p": p}
    zero, free = np.zeros(nlp["g"].numel()), np.full(s.column.numel(), np.inf)
    frames = np.zeros((m + 1, 3))
    return NonlinearProgram(
        nlp, -free, free, zero, zero, np.zeros(0), frames, vehicle, m, with_derivatives(nlp, gaps, equal.T)
    )
