"""Last point to steer: the shortest way to a lateral offset, by direct multiple shooting."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from fmus.planner import compiled
from fmus.planner.errors import PlanningError
from fmus.planner.evasion.car import Means, input_limits, motion
from fmus.planner.gates import Array
from fmus.planner.program import Nodes, Program, decision, roughness, scaled
from fmus.planner.shooting import interval
from fmus.planner.vehicle import Vehicle, two_wheel_drive
from fmus.single_track.data import Car, car

_SUBSTEPS = 2
_SMOOTHING = 1e-4
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

    def __init__(self, data: Car | None = None, *, edge: bool, compile_: bool = True) -> None:
        self._car = data or car()
        self._vehicle = two_wheel_drive(self._car)
        self._counts = _WITH_EDGE if edge else _WITHOUT_EDGE
        self._program = _program(self._vehicle, motion(self._car), self._counts)
        self._solver = compiled.solver(self._program, _OPTIONS, compile_=compile_)

    def solve(self, task: Task) -> LastPoint:
        """The last point of the task; raises PlanningError when no motion of the car does it."""
        if (task.edge is not None) != (len(self._counts) == 2):
            raise PlanningError("a task with an edge needs a search with one")
        lower, upper = self._bounds(task)
        call, limit = self._solver.call, self._program
        x0 = np.clip(self._packed(self._guess(task)), lower, upper)
        weights = (1.0, 0.0) if task.within is None else (0.0, -1.0)
        found = call(x0=x0, lbx=lower, ubx=upper, lbg=limit.g_lower, ubg=limit.g_upper, p=[task.friction, *weights])
        stats = call.stats()
        if not stats["success"]:
            raise PlanningError(
                f"no motion leads {task.offset:g} m to the side from {task.speed:g} m/s on friction "
                f"{task.friction:g} (IPOPT: {stats['return_status']}); ask for less"
            )
        nodes = self._nodes(found["x"].full().ravel())
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
        phases = len(self._counts)
        return scaled(v, low, least, np.full(phases, _SHORTEST)), scaled(v, high, most, np.array(_LONGEST[:phases]))

    def _guess(self, task: Task) -> Nodes:
        """A quadratic way to the side within the grip, a mirrored one back."""
        m, turn = sum(self._counts), self._counts[0]
        T = np.array([np.sqrt(2 * task.offset / (4.0 * task.friction)) + 0.2, _BACK])[: len(self._counts)]
        steps = np.repeat(T / np.array(self._counts), self._counts)
        times = np.concatenate([[0], np.cumsum(steps)])
        tau = np.concatenate([np.linspace(0, 1, turn + 1), np.linspace(1, 2, m - turn + 1)[1:]])
        x = np.zeros((7, m + 1))
        x[0], x[2] = task.speed * times, task.speed
        x[1] = task.offset * np.where(tau < 1, tau**2, 1) + 0.1 * np.maximum(tau - 1, 0)
        return Nodes(x, np.zeros((3, m)), steps)

    def _packed(self, nodes: Nodes) -> Array:
        v = self._vehicle
        parts = (nodes.x / v.scale[:, None]).ravel("F"), (nodes.u / v.input_scale[:, None]).ravel("F")
        ends = np.cumsum(self._counts) - 1
        return np.concatenate([*parts, nodes.T[ends] * self._counts])

    def _nodes(self, w: Array) -> Nodes:
        v, m = self._vehicle, sum(self._counts)
        x, u, T = np.split(w, [7 * (m + 1), 10 * m + 7])
        return Nodes(
            x.reshape((7, m + 1), order="F") * v.scale[:, None],
            u.reshape((3, m), order="F") * v.input_scale[:, None],
            np.repeat(T / np.array(self._counts), self._counts),
        )


@cache
def search(*, edge: bool, compile_: bool = True) -> Search:
    """The search of the default car."""
    return Search(edge=edge, compile_=compile_)


def _program(vehicle: Vehicle, f: ca.Function, counts: tuple[int, ...]) -> Program:
    """Minimise w_x x + w_y y at the end of the first phase, with free durations; the parameters are mu, w_x, w_y."""
    m, p = sum(counts), ca.MX.sym("p", 3)
    s = decision(vehicle, m, len(counts))
    T = ca.horzcat(*(ca.repmat(s.T[k] / count, 1, count) for k, count in enumerate(counts)))
    reached = interval(f, _SUBSTEPS).map(m)(s.x[:, :-1], ca.vertcat(s.u, ca.repmat(p[0], 1, m)), T)
    gaps = ca.vec(ca.diag(1 / ca.DM(vehicle.scale)) @ reached - s.X[:, 1:])
    cost = ca.dot(p[1:], s.X[:2, counts[0]]) + _SMOOTHING * roughness(s)
    if len(counts) == 2:
        cost += 1e-3 * s.T[1]
    nlp = {"x": s.column, "f": cost, "g": gaps, "p": p}
    zero = np.zeros(gaps.numel())
    none = np.zeros(0)
    return Program(nlp, none, none, zero, zero, none, np.zeros((m + 1, 3)), vehicle, len(counts))
