"""Car and obstacle as rectangles in the plane, seen from above, and their distances."""

from __future__ import annotations

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from fmus.planner.evasion.situation import Surroundings
from scenarios.collision_avoidance.evasion import Evasion
from scenarios.shared.rectangles import footprint, separation


def car(results: Results, surroundings: Surroundings) -> Vector:
    """The car's rectangles (n, 4, 2) [m]."""
    s = surroundings
    x, y, yaw = (results[f"plant.{name}"] for name in ("position.x", "position.y", "yaw"))
    return footprint(x, y, yaw, s.front, s.rear, s.car_width)


def obstacle(planned: Evasion) -> Vector:
    """The obstacle's rectangle (4, 2) [m]; O1 is at the origin when it appears."""
    met = planned.encounter
    place = np.array([planned.surroundings.front + met.distance]), np.zeros(1), np.zeros(1)
    return np.asarray(footprint(*place, met.length, 0.0, met.width)[0])


def clearance(results: Results, planned: Evasion) -> Vector:
    """Distance [m] of the car from the obstacle over time."""
    return separation(car(results, planned.surroundings), obstacle(planned))


def passed(results: Results, planned: Evasion) -> bool:
    """Whether the whole car is beyond the obstacle at the end."""
    return bool(car(results, planned.surroundings)[-1, :, 0].min() > obstacle(planned)[:, 0].max())


def road_margin(results: Results, surroundings: Surroundings) -> float:
    """Least distance [m] of the car's corners from the edges of the road; negative when it leaves the road."""
    s, y = surroundings, car(results, surroundings)[:, :, 1]
    return float(min(y.min() + 0.5 * s.lane, 1.5 * s.lane - y.max()))
