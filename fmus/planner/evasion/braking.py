"""Stopping in a straight line: the closed form, and the car of the planner with its force limits."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from fmus.cars import published
from fmus.cars.single_track import SingleTrackCar
from fmus.planner.evasion.car import evading_car
from fmus.planner.gates import Array

_CREEP = 0.1
"""Speed [m/s] at which the integration ends; what is left of the way is added in closed form."""


def stopping_distance(speed: float, friction: float, deceleration: float) -> float:
    """v0^2/(2 a_b mu) [m]: the brakes reach a_b [m/s2] at friction 1, and less in proportion."""
    return speed**2 / (2 * deceleration * friction)


def stopping_distance_of_car(speed: float, friction: float, data: SingleTrackCar | None = None) -> float:
    """The way [m] of the single-track car with all the brake force it may use, rolling resistance and drag."""
    vehicle = evading_car(data or published.single_track(), friction, "brake")
    u = np.array([0.0, *vehicle.input_lower[1:]])

    def rate(_: float, s: Array) -> Array:
        x_dot = vehicle.f([s[0], 0, s[1], 0, 0, 0, 0], u).full().ravel()
        return np.array([x_dot[0], x_dot[2]])

    def slow(_: float, s: Array) -> float:
        return float(s[1] - _CREEP)

    slow.terminal = True  # type: ignore[attr-defined]
    end = solve_ivp(rate, (0, 200), [0.0, speed], events=slow, rtol=1e-8, atol=1e-8)
    last = -rate(0.0, end.y[:, -1])[1]
    return float(end.y[0, -1] + end.y[1, -1] ** 2 / (2 * last))


def impact_speed(speed: float, friction: float, deceleration: float, distance: float) -> float:
    """Speed [m/s] after braking over `distance` [m]; 0 when the car has stopped before."""
    return float(np.sqrt(max(0.0, speed**2 - 2 * deceleration * friction * distance)))
