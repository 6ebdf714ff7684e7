"""How a car turns in the linear range, from its cornering stiffnesses alone."""

from __future__ import annotations

from fmus.cars.single_track import SingleTrackCar


def understeer_gradient(car: SingleTrackCar) -> float:
    """m (l_R/C_F - l_F/C_R)/L [rad/(m/s2)]."""
    parts = car.l_R / car.front.cornering_stiffness - car.l_F / car.rear.cornering_stiffness
    return car.m * parts / car.wheelbase
