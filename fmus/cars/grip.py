"""A car on a road, or with a reserve, that leaves its tyres part of their grip."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from fmus.cars.single_track import SingleTrackCar, Tyre


def with_grip(car: SingleTrackCar, part: Any) -> SingleTrackCar:
    """The car with this `part` (> 0) of its lateral peaks, a number or a symbol; the slip stiffnesses keep."""
    return replace(car, front=_with_grip(car.front, part), rear=_with_grip(car.rear, part))


def _with_grip(tyre: Tyre, part: Any) -> Tyre:
    return replace(tyre, B=tyre.B / part, D=tyre.D * part)
