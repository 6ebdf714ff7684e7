"""What the planner knows of a car: its motion, its limits, and the size of its numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from fmus.cars.nominal import DESIGN, DesignModel
from fmus.planner.errors import PlanningError
from fmus.planner.gates import Array
from fmus.single_track import gear_shift, model
from fmus.single_track.data import Car
from fmus.single_track.design import design_car
from fmus.single_track.forces import STATES

_STATE_LIMITS = np.array([np.inf, np.inf, 60.0, 0.5, np.inf, np.inf, 0.6])
_STATE_SCALE = np.array([10.0, 1.0, 10.0, 0.1, 0.1, 0.3, 0.1])
_SLOWEST = 3.0
GRIP = 0.8
"""Part of the grip of Vehicle16Dof that plans use (engineering choice)."""
MOST_SLIP = 0.12
"""Slip angle [rad] to which the axles of Vehicle16Dof are fitted; engineering choice: beyond it plans would drift."""


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
    car: Car,
    *,
    friction: float | None = None,
    steering_rate: float = 0.5,
    front: tuple[float, float] = (-1e4, 0.0),
    rear: tuple[float, float] = (-5e3, 5e3),
) -> Vehicle:
    """Single-track car with brake forces in front, drive and brake behind [N]; bounds are engineering choices.

    For Vehicle16Dof rather plan with `vehicle16dof`.
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
    car: Car, *, friction: float, steering_rate: float = 0.5, force: tuple[float, float] = (-9e3, 5e3)
) -> Vehicle:
    """Single-track car driven and braked by one force U [N] that the axles share as their loads; inputs omega_delta, U.

    Every wheel then spends the same part |U|/(friction m g) of its grip on it. Neither axle slips by more than
    `MOST_SLIP`. Bounds are engineering choices.
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


def vehicle16dof(grip: float = GRIP, design: DesignModel = DESIGN) -> Vehicle:
    """The car to plan with for Vehicle16Dof: its single-track car with the part `grip` of its grip, on four wheels.

    What is left of the grip is for the controller, for load transfer by braking and for tyres that lag behind. Default
    bounds are within what LowLevelPid and MpcAllocator may ask of motors and brakes. README.md says how well the car
    follows.
    """
    return four_wheel_drive(with_grip(design_car(design), grip), friction=grip)


def with_grip(car: Car, grip: float) -> Car:
    """The car on tyres with the part `grip` (0, 1] of their peaks, slip stiffnesses kept; else raises PlanningError."""
    if not 0 < grip <= 1:
        raise PlanningError(f"the part of the grip to plan with is {grip:g}; give a number above 0, at most 1")
    front, rear = (replace(tyre, B=tyre.B / grip, D=tyre.D * grip) for tyre in (car.front, car.rear))
    return replace(car, front=front, rear=rear)


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


def _shared(inputs: int, forces: Callable[[ca.SX], ca.SX]) -> ca.Function:
    """u -> forces of the axles."""
    u = ca.SX.sym("u", inputs)
    return ca.Function("axle_forces", [u], [forces(u)])
