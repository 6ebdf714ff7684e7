"""Cars to plan with, by name: the single-track car of the planner and the double-track car of its forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

from fmus.double_track import data as double_track
from fmus.double_track.data import DoubleTrackCar
from fmus.double_track.design import double_track_car
from fmus.planner.vehicle import GRIP, Vehicle, two_wheel_drive, vehicle16dof, with_grip
from fmus.single_track.data import car


@dataclass(frozen=True, slots=True)
class PlannedCar:
    """`vehicle` is planned, on the single-track car `whole.planar`; `whole` takes its motion to four wheels."""

    vehicle: Vehicle
    whole: DoubleTrackCar


def thesis() -> PlannedCar:
    """The published car, driven on its rear axle: DoubleTrack with its start values."""
    return PlannedCar(two_wheel_drive(car()), double_track.car())


def multibody(grip: float = GRIP) -> PlannedCar:
    """The car that stands for Vehicle16Dof, with the part `grip` of its grip; see `vehicle.vehicle16dof`."""
    whole = double_track_car()
    return PlannedCar(vehicle16dof(grip), replace(whole, planar=with_grip(whole.planar, grip)))


CARS: dict[str, Callable[[], PlannedCar]] = {"doubletrack": thesis, "vehicle16dof": multibody}
