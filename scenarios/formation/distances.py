"""How near cars come to each other, as rectangles in the plane: 50 cars in a fraction of a second."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from cosim.scenario.metric import Metric, truth
from fmus.planner.evasion.situation import Surroundings
from scenarios.shared.rectangles import footprint, separation

BLOCK = 100_000
"""Centre distances computed at once: what fits into the cache."""


@dataclass(frozen=True, slots=True)
class Outline:
    """How far the car reaches from O1 to the front and back, and how wide it is [m]."""

    ahead: float
    behind: float
    width: float

    @property
    def diagonal(self) -> float:
        return math.hypot(self.ahead + self.behind, self.width)


def distance_metrics(results: Results, cars: Sequence[int]) -> dict[str, Metric]:
    """`distance_min` [m] of any two cars and `collision`, 1 if two touched; NaN for a car alone."""
    least = smallest_distance(np.stack([_poses(results, car) for car in cars], axis=1), usual_outline())
    touched = math.nan if math.isnan(least) else float(least <= 0.0)
    return {"distance_min": Metric(least, "m"), "collision": truth(touched)}


def usual_outline() -> Outline:
    """That of all cars."""
    s = Surroundings()
    return Outline(s.front, s.rear, s.car_width)


def smallest_distance(poses: Vector, outline: Outline) -> float:
    """Of any two cars with poses x, y, yaw (n, cars, 3) over all times [m]; 0 when two overlap, NaN for one car.

    A rectangle holds the circle of its width and lies in that of its diagonal, so only pairs whose centres are within
    the least centre distance + diagonal - width can be the nearest ones; those are measured exactly.
    """
    if poses.shape[1] < 2:
        return math.nan
    centres = _centres(poses, outline)
    near = min(float(d.min()) for _, d in _blocks(centres))
    reach = near + outline.diagonal - outline.width
    best = math.inf
    for rows, d in _blocks(centres):
        time, pair = np.nonzero(d <= reach)
        if len(time):
            one, two = (poses[rows][time, car[pair]] for car in np.triu_indices(poses.shape[1], 1))
            best = min(best, float(separation(_rectangles(one, outline), _rectangles(two, outline)).min()))
    return best


def _blocks(centres: Vector) -> Iterable[tuple[slice, Vector]]:
    """Slices of the times with the centre distances (m, pairs) [m] then."""
    one, two = np.triu_indices(centres.shape[1], 1)
    step = max(1, BLOCK // len(one))
    for begin in range(0, len(centres), step):
        block = centres[begin : begin + step]
        yield slice(begin, begin + step), np.hypot(*np.moveaxis(block[:, one] - block[:, two], -1, 0))


def _centres(poses: Vector, outline: Outline) -> Vector:
    middle = 0.5 * (outline.ahead - outline.behind)
    return np.asarray(poses[..., :2] + middle * np.stack((np.cos(poses[..., 2]), np.sin(poses[..., 2])), -1))


def _rectangles(poses: Vector, outline: Outline) -> Vector:
    return footprint(poses[:, 0], poses[:, 1], poses[:, 2], outline.ahead, outline.behind, outline.width)


def _poses(results: Results, car: int) -> Vector:
    return np.stack([results[f"car{car}.plant.{name}"] for name in ("position.x", "position.y", "yaw")], -1)
