"""How a car turns in the linear range, from the slopes of its tyres alone."""

from __future__ import annotations

from fmus.cars.single_track import SingleTrackCar, Tyre


def cornering_stiffness(tyre: Tyre) -> float:
    """Slope BCD [N/rad] of the magic formula at zero slip."""
    return tyre.B * tyre.C * tyre.D


def understeer_gradient(car: SingleTrackCar) -> float:
    """m (l_R/C_F - l_F/C_R)/L [rad/(m/s2)]."""
    C_F, C_R = cornering_stiffness(car.front), cornering_stiffness(car.rear)
    return car.m * (car.l_R / C_F - car.l_F / C_R) / car.wheelbase
