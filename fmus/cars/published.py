"""The published car (Gerdts, mintOC), with what a double-track car needs beyond it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

from fmukit.interface import Variable, load_parameters
from fmus.cars.double_track import DoubleTrackCar, double_track_car
from fmus.cars.single_track import SingleTrackCar

_HERE = Path(__file__).parent


def single_track_parameters() -> tuple[Variable, ...]:
    """The parameters of the single-track car."""
    return load_parameters(_HERE / "single_track.toml")


def double_track_parameters() -> tuple[Variable, ...]:
    """The parameters of the double-track car, those of the single-track car first."""
    return *single_track_parameters(), *load_parameters(_HERE / "double_track.toml")


@cache
def double_track() -> DoubleTrackCar:
    """The car with four wheels."""
    return double_track_car({variable.name: float(variable.start) for variable in double_track_parameters()})


def single_track() -> SingleTrackCar:
    """The car with one wheel per axle."""
    return double_track().planar
