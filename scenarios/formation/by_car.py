"""Metrics of every car, and the worst of all."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping

from cosim.scenario.metric import Metric
from scenarios.formation.topology import prefix


def by_car(figures: Mapping[int, Mapping[str, float]], units: Mapping[str, str]) -> dict[str, Metric]:
    """What `figures` says by number of the car, as `car2.NAME`, and before it the largest over all cars, as `NAME`.

    `units` are those of all figures there are, by name; the largest is NaN where no car has that figure.
    """
    worst = {
        name: Metric(largest(of_car[name] for of_car in figures.values() if name in of_car), unit)
        for name, unit in units.items()
    }
    single = {
        f"{prefix(car)}{name}": Metric(value, units[name])
        for car, of_car in figures.items()
        for name, value in of_car.items()
    }
    return {**worst, **single}


def largest(values: Iterable[float]) -> float:
    """The largest that is a number; NaN when there is none."""
    return max((value for value in values if not math.isnan(value)), default=math.nan)
