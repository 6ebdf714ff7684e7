"""What the planner knows of a car: its motion, its limits, and the size of its numbers."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from fmus.planner.gates import Array
from fmus.single_track import gear_shift, model
from fmus.single_track.data import Car

_STATE_LIMITS = np.array([np.inf, np.inf, 60.0, 0.5, np.inf, np.inf, 0.6])
_STATE_SCALE = np.array([10.0, 1.0, 10.0, 0.1, 0.1, 0.3, 0.1])
_SLOWEST = 3.0


@dataclass(frozen=True, slots=True)
class Vehicle:
    """`f` (x, u) -> x' over the states of the single-track car; bounds and scales of states and inputs.

    `limits` (x, u) -> values that must not exceed 0; `idle` inputs to begin the search with.
    """

    name: str
    f: ca.Function
    lower: Array
    upper: Array
    scale: Array
    input_lower: Array
    input_upper: Array
    input_scale: Array
    idle: Array
    limits: ca.Function | None = None


def two_wheel_drive(
    car: Car,
    *,
    friction: float | None = None,
    steering_rate: float = 0.5,
    front: tuple[float, float] = (-1e4, 0.0),
    rear: tuple[float, float] = (-5e3, 5e3),
) -> Vehicle:
    """Single-track car with brake forces in front, drive and brake behind [N]; bounds are engineering choices."""
    low, high = np.array([-steering_rate, front[0], rear[0]]), np.array([steering_rate, front[1], rear[1]])
    return Vehicle(
        "two_wheel_drive",
        model.function(car, friction),
        _lowest(),
        _STATE_LIMITS,
        _STATE_SCALE,
        low,
        high,
        np.array([0.5, 5e3, 5e3]),
        np.array([0.0, 0.0, 0.5 * high[2]]),
    )


def gear_shift_car(car: Car) -> Vehicle:
    """The published car with five relaxed gears."""
    x, u = ca.SX.sym("x", 7), ca.SX.sym("u", len(gear_shift.INPUTS))
    return Vehicle(
        "gear_shift",
        gear_shift.function(car),
        _lowest(),
        _STATE_LIMITS,
        _STATE_SCALE,
        np.array([-0.5, 0, 0, 0, 0, 0, 0.0]),
        np.array([0.5, 1.5e4, 1, 1, 1, 1, 1]),
        np.array([0.5, 5e3, 1, 1, 1, 1, 1]),
        np.array([0.0, 0, 0.9, 0.3, 0.3, 0.1, 0.1]),
        ca.Function("limits", [x, u], [ca.sum1(u[3:]) - 1]),
    )


def _lowest() -> Array:
    low = -_STATE_LIMITS
    low[2] = _SLOWEST
    return low
