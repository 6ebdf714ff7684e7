"""The time-optimal lane change past an obstacle: a plan on gates whose lower bound rises where the obstacle begins."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fmus.cars import published
from fmus.cars.grip import with_grip
from fmus.cars.single_track import SingleTrackCar
from fmus.planner import hocp
from fmus.planner.evasion.car import Means, evading_car
from fmus.planner.evasion.situation import Encounter, Surroundings
from fmus.planner.gates import Array, Gates, checked
from fmus.planner.hocp import Plan, PlanSettings
from fmus.planner.program import Ends, Nodes

_BEFORE, _AFTER = 30, 45
"""Intervals before the obstacle and from there to the end."""
_SETTLE = 2.6
"""Time [s] at the first speed in which the car is straight again; the last points allow 2.4 s."""
_SMOOTHING = 1e-3
_GRIP = 0.96
"""Part of the tyres' lateral grip that a plan uses; the rest is for the controller (engineering choice)."""
_SLOWEST = 0.4
"""Part of its speed that the car keeps; keeps the search from plans that nearly stop (engineering choice)."""


@dataclass(frozen=True, slots=True)
class EvasionRoad:
    """Along x: free from `right` to `edge` up to `turn`, then from `offset` to `edge` up to `end` [m]."""

    turn: float
    end: float
    right: float
    offset: float
    edge: float

    def gates(self, m: int) -> Gates:
        """m + 1 gates, one of them at the turn, at equal distances before it and after it."""
        before = max(1, round(m * _BEFORE / (_BEFORE + _AFTER)))
        x = np.concatenate(
            [np.linspace(0, self.turn, before + 1), np.linspace(self.turn, self.end, m - before + 1)[1:]]
        )
        low = np.where(np.arange(m + 1) < before, self.right, self.offset)
        return checked(Gates(np.column_stack([x, 0 * x, 0 * x]), low, np.full(m + 1, self.edge)))

    def violation(self, points: Array) -> float:
        """Largest distance [m] by which the points (n, 2) leave the road."""
        low = np.where(points[:, 0] < self.turn - 1e-9, self.right, self.offset)
        return float(max(0.0, np.max(low - points[:, 1]), np.max(points[:, 1] - self.edge)))


def road(encounter: Encounter, surroundings: Surroundings) -> EvasionRoad:
    """The road from where the manoeuvre begins; the centre of gravity has its offset when the nose is at the obstacle.

    That is a car's front earlier than the nose needs it, which is what the yaw angle costs.
    """
    s, e = surroundings, encounter
    left = e.distance - s.delay * e.speed
    end = left + max(_SETTLE * e.speed, s.front + e.length + s.rear + 10)
    return EvasionRoad(left, end, s.right, s.offset(e.width), s.edge)


def ends(speed: float, lane: float) -> Ends:
    """Straight in the middle of the own lane, then straight in the middle of the other one."""
    return Ends(np.array([0.0, 0, speed, 0, 0, 0, 0]), np.array([0.0, lane, np.nan, 0, 0, 0, 0]))


def lane_change(
    encounter: Encounter, means: Means, surroundings: Surroundings, data: SingleTrackCar | None = None
) -> Plan:
    """The plan; raises PlanningError when there is none. Evaluated in one way, so that its digits always agree."""
    gripping = with_grip(data or published.single_track(), _GRIP)
    vehicle = evading_car(gripping, encounter.friction, means, slowest=_SLOWEST * encounter.speed)
    settings = PlanSettings(compile=False, smoothing=_SMOOTHING)
    way, both = road(encounter, surroundings), ends(encounter.speed, surroundings.lane)
    start = _at_constant_speed(way, encounter.speed, surroundings.lane)
    return hocp.plan(vehicle, way, _BEFORE + _AFTER, both, settings, start=start)


def _at_constant_speed(way: EvasionRoad, speed: float, lane: float) -> Nodes:
    """Where the search begins."""
    x = way.gates(_BEFORE + _AFTER).frames[:, 0]
    s = np.clip(0.7 * x / way.turn, 0, 1)
    states = np.zeros((7, len(x)))
    states[0], states[1], states[2] = x, lane * s**3 * (10 - 15 * s + 6 * s**2), speed
    states[4] = np.arctan(np.gradient(states[1], x))
    T = np.diff(x) / speed
    return Nodes(states, np.zeros((3, len(T))), T)
