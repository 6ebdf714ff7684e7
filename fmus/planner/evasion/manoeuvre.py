"""The manoeuvre as a trajectory: straight on while the car reacts, then what was decided."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache

import numpy as np

from fmus.cars import published
from fmus.cars.single_track import SingleTrackCar
from fmus.controllers.reference.interface import ROWS
from fmus.planner import trajectory
from fmus.planner.check import fine
from fmus.planner.errors import PlanningError
from fmus.planner.evasion.car import Means, evading_car
from fmus.planner.evasion.decision import Decision, decide
from fmus.planner.evasion.lane_change import lane_change
from fmus.planner.evasion.last_point import Search, Task
from fmus.planner.evasion.situation import Encounter, Surroundings
from fmus.planner.evasion.table import LastPointTable, read
from fmus.planner.gates import Array

_STEP, _JUMP = 0.02, 1e-3
"""Rows of a stop are `_STEP` [s] apart; an acceleration changes within `_JUMP` [s]."""
_CLOSEST = 1e-6
"""Least time [s] between rows; the file keeps nine digits."""
_FINER = 4
_WORTH = 5.0
"""Impact speed [m/s] below which a car that cannot avoid the obstacle only brakes."""
_MEANS: dict[str, Means] = {"steer": "steer", "brake and steer": "brake"}


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """The `decision` and the trajectory, rows (n, 7) of time, x, y, course, speed, acceleration, curvature.

    It begins at the origin, along x, when the obstacle appears.
    """

    decision: Decision
    rows: Array


def manoeuvre(
    encounter: Encounter,
    table: LastPointTable | None = None,
    surroundings: Surroundings | None = None,
    data: SingleTrackCar | None = None,
) -> Manoeuvre:
    """Decide and plan; raises PlanningError for an encounter that cannot be, or without a plan."""
    s = surroundings or Surroundings()
    decision = decide(encounter, table or read(), s)
    rows = _rows(encounter, decision, s, data or published.single_track())
    return Manoeuvre(decision, _playable(_delayed(rows, encounter.speed, s)))


def stop(speed: float, deceleration: float, *, x: float = 0.0, y: float = 0.0, course: float = 0.0) -> Array:
    """Rows (n, 7) of a straight stop from t = 0; the last is at rest."""
    duration = speed / deceleration
    steps = math.ceil((duration - 2 * _JUMP) / _STEP)
    t = np.append(_STEP * np.arange(steps), [duration - _JUMP, duration])
    s, v = speed * t - 0.5 * deceleration * t**2, np.maximum(speed - deceleration * t, 0)
    a = np.where(t < duration, -deceleration, 0)
    zero = np.zeros_like(t)
    return np.column_stack([t, x + s * np.cos(course), y + s * np.sin(course), zero + course, v, a, zero])


def _playable(rows: Array) -> Array:
    """The rows, if ReferenceTrajectory can play them; else raises PlanningError."""
    if not (np.isfinite(rows).all() and len(rows) <= ROWS and (np.diff(rows[:, 0]) > _CLOSEST).all()):
        raise PlanningError(
            f"the manoeuvre has {len(rows)} rows; at most {ROWS} finite ones whose time increases can be played, "
            "so change the encounter a little"
        )
    return rows


def _rows(e: Encounter, decision: Decision, s: Surroundings, data: SingleTrackCar) -> Array:
    """From the beginning of the manoeuvre on, from the origin."""
    deceleration = s.deceleration * e.friction
    if decision.action in _MEANS:
        return trajectory.table(lane_change(e, _MEANS[decision.action], s, data))
    steers = decision.impact > _WORTH and decision.left > 0 and decision.steer < math.inf
    if decision.action == "mitigate" and steers:
        begin = _brake_and_steer(e, decision.left, s, data)
        t, x, y, course, speed = begin[-1, :5]
        end = stop(speed, deceleration, x=x, y=y, course=course)
        return np.vstack([begin[:-1], end + np.array([t, 0, 0, 0, 0, 0, 0])])
    return stop(e.speed, deceleration)


def _brake_and_steer(e: Encounter, left: float, s: Surroundings, data: SingleTrackCar) -> Array:
    """Rows up to the obstacle: all brakes, and as far to the side as the grip left by them allows."""
    found = _search(data).solve(Task(e.speed, e.friction, s.offset(e.width), "full brakes", within=left))
    vehicle = evading_car(data, e.friction, "full brakes")
    times, x, u = fine(vehicle, found.nodes, 2, _FINER)
    return trajectory.rows(vehicle, times, x, u)


@cache
def _search(data: SingleTrackCar) -> Search:
    return Search(data, edge=False, compile_=False)


def _delayed(rows: Array, speed: float, s: Surroundings) -> Array:
    """The rows moved on by the delay, with straight driving at constant speed before them."""
    if s.reaction_time < _JUMP:
        raise PlanningError(f"the reaction time is {s.reaction_time:g} s; give at least {_JUMP:g} s")
    time = s.delay
    moved = rows + np.array([time, speed * time, 0, 0, 0, 0, 0])
    t = np.array([0, time - _JUMP])
    zero = np.zeros_like(t)
    return np.vstack([np.column_stack([t, speed * t, zero, zero, zero + speed, zero, zero]), moved])
