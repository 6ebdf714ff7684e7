"""Cars to plan with: the single-track car of the planner and the double-track car of its wheel forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fmus.cars import derived, published
from fmus.cars.assumed import AssumedCar
from fmus.cars.double_track import DoubleTrackCar
from fmus.cars.grip import with_grip
from fmus.cars.nominal import DESIGN
from fmus.planner.errors import PlanningError
from fmus.planner.vehicle import Vehicle, four_wheel_drive, two_wheel_drive

GRIP = 0.8
"""Part of the grip of Vehicle16Dof that plans use (engineering choice)."""


@dataclass(frozen=True, slots=True)
class PlannedCar:
    """`vehicle` is planned, on the single-track car `whole.planar`; `whole` takes its motion to four wheels."""

    vehicle: Vehicle
    whole: DoubleTrackCar


def thesis() -> PlannedCar:
    """The published car, driven on its rear axle: DoubleTrack with its start values."""
    whole = published.double_track()
    return PlannedCar(two_wheel_drive(whole.planar), whole)


def multibody(car: AssumedCar, grip: float = GRIP) -> PlannedCar:
    """What stands for a Vehicle16Dof assumed to be `car`: driven on four wheels, with the part `grip` of its grip.

    What is left of the grip is for the controller, for load transfer by braking and for tyres that lag behind. Default
    bounds are within what LowLevelPid and MpcAllocator may ask of motors and brakes. README.md says how well the car
    follows. Raises PlanningError unless 0 < `grip` <= 1.
    """
    if not 0 < grip <= 1:
        raise PlanningError(f"the part of the grip to plan with is {grip:g}; give a number above 0, at most 1")
    whole = derived.double_track(car)
    planar = with_grip(whole.planar, grip)
    return PlannedCar(four_wheel_drive(planar, friction=grip), replace(whole, planar=planar))


CARS: dict[str, Callable[[], PlannedCar]] = {"doubletrack": thesis, "vehicle16dof": lambda: multibody(DESIGN)}
"""By the name of the plant they are planned for, which has its start values."""
