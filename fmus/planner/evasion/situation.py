"""What the car meets: an obstacle ahead in its own lane of a two-lane road, and what is known of car and road."""

from __future__ import annotations

import math
from dataclasses import dataclass

from fmus.planner.errors import PlanningError


@dataclass(frozen=True, slots=True)
class Surroundings:
    """Car, road and habits; lengths in m, reaction time in s, deceleration in m/s2. All are engineering choices.

    The car drives in the middle of its lane, y = 0; the other lane lies to its left and is free. `front` and `rear`
    are the distances of the bumpers from the centre of gravity. `clearance` is kept from the obstacle and
    `edge_clearance` from the far edge of the road. `reserve`: by how much more than the shortest way must be left for
    the car to steer, because no controller follows the optimum at the limit of grip. `standstill_gap` [m]: what a
    stop must leave before the obstacle, for the same reason. `lead` [s]: a controller that sees the plan ahead begins
    so much before it; the manoeuvre is planned that much later, so that the car does nothing while it reacts.
    """

    car_width: float = 1.68
    front: float = 2.0
    rear: float = 2.3
    lane: float = 3.5
    clearance: float = 0.5
    edge_clearance: float = 0.45
    reaction_time: float = 0.3
    lead: float = 0.08
    deceleration: float = 8.0
    reserve: float = 1.05
    standstill_gap: float = 0.5

    @property
    def road(self) -> float:
        """Width of both lanes."""
        return 2 * self.lane

    @property
    def delay(self) -> float:
        """Time [s] from when the obstacle appears to the planned beginning of the manoeuvre."""
        return self.reaction_time + self.lead

    @property
    def edge(self) -> float:
        """The largest lateral position of the centre of gravity."""
        return 1.5 * self.lane - 0.5 * self.car_width - self.edge_clearance

    @property
    def right(self) -> float:
        """The least lateral position of the centre of gravity."""
        return -(0.5 * self.lane - 0.5 * self.car_width - self.edge_clearance)

    def offset(self, width: float) -> float:
        """Lateral position of the centre of gravity beside an obstacle of `width` in the middle of the car's lane."""
        return 0.5 * (width + self.car_width) + self.clearance


@dataclass(frozen=True, slots=True)
class Encounter:
    """An obstacle at rest appears `distance` [m] ahead of the front bumper at `speed` [m/s].

    `width` across and `length` along the road [m]; `friction` of the road.
    """

    speed: float
    distance: float
    friction: float = 1.0
    width: float = 2.0
    length: float = 4.5


def checked(encounter: Encounter, surroundings: Surroundings) -> Encounter:
    """The encounter, if it can be; else raises PlanningError."""
    e = encounter
    for name in ("speed", "distance", "friction", "width", "length"):
        value = getattr(e, name)
        if not (math.isfinite(value) and value > 0):
            thing = {"distance": "distance of the obstacle", "speed": "speed", "friction": "friction"}
            raise PlanningError(
                f"the {thing.get(name, f'{name} of the obstacle')} is {value:g}; give a positive finite number"
            )
    if e.width > surroundings.road:
        raise PlanningError(
            f"the obstacle is {e.width:g} m wide, wider than the road of {surroundings.road:g} m; give less"
        )
    return e
