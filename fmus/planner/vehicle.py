"""What the planner knows of a car: its motion, its limits, and the size of its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from fmus.cars.axle_fit import MOST_SLIP
from fmus.cars.single_track import SingleTrackCar
from fmus.planner.gates import Array
from fmus.single_track import model
from fmus.single_track.forces import STATES

_STATE_LIMITS = np.array([np.inf, np.inf, 60.0, 0.5, np.inf, np.inf, 0.6])
_STATE_SCALE = np.array([10.0, 1.0, 10.0, 0.1, 0.1, 0.3, 0.1])
_SLOWEST = 3.0


@dataclass(frozen=True, slots=True)
class Vehicle:
    """`f` (x, u) -> x' over the states of the single-track car; bounds and scales of states and inputs.

    `limits` (x, u) -> values that must not exceed 0; `idle` inputs to begin the search with. `axle_forces`: u -> forces
    of the front and the rear axle [N], where the first input is the steering rate; `friction` of the friction ellipse.
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
    axle_forces: ca.Function | None = None
    friction: float | None = None


def two_wheel_drive(
    car: SingleTrackCar,
    *,
    friction: float | None = None,
    steering_rate: float = 0.5,
    front: tuple[float, float] = (-1e4, 0.0),
    rear: tuple[float, float] = (-5e3, 5e3),
) -> Vehicle:
    """Single-track car with brake forces in front, drive and brake behind [N]; bounds are engineering choices.

    For Vehicle16Dof rather plan with `planned_cars.multibody`.
    """
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
        axle_forces=_shared(3, lambda u: u[1:]),
        friction=friction,
    )


def four_wheel_drive(
    car: SingleTrackCar, *, friction: float, steering_rate: float = 0.5, force: tuple[float, float] = (-9e3, 5e3)
) -> Vehicle:
    """Single-track car driven and braked by one force U [N] that the axles share as their loads; inputs omega_delta, U.

    Every wheel then spends the same part |U|/(friction m g) of its grip on it. Neither axle slips by more than
    MOST_SLIP, to which axles are fitted: beyond it plans would drift. Bounds are engineering choices.
    """
    front, rear = (load / sum(car.static_loads) for load in car.static_loads)
    axles = _shared(2, lambda u: ca.vertcat(front * u[1], rear * u[1]))
    x, u = ca.SX.sym("x", len(STATES)), ca.SX.sym("u", 2)
    x_dot = model.derivative(car, x, ca.vertcat(u[0], axles(u)), friction)
    slips = ca.vertcat(*model.slips(car, x))
    low, high = np.array([-steering_rate, force[0]]), np.array([steering_rate, force[1]])
    return Vehicle(
        "four_wheel_drive",
        ca.Function("four_wheel_drive", [x, u], [ca.cse(x_dot)]),
        _lowest(),
        _STATE_LIMITS,
        _STATE_SCALE,
        low,
        high,
        np.array([0.5, 5e3]),
        np.array([0.0, 0.5 * high[1]]),
        ca.Function("limits", [x, u], [ca.vertcat(slips - MOST_SLIP, -slips - MOST_SLIP) / MOST_SLIP]),
        axles,
        friction,
    )


def _lowest() -> Array:
    low = -_STATE_LIMITS
    low[2] = _SLOWEST
    return low


def _shared(inputs: int, forces: Callable[[ca.SX], ca.SX]) -> ca.Function:
    """u -> forces of the axles."""
    u = ca.SX.sym("u", inputs)
    return ca.Function("axle_forces", [u], [forces(u)])
