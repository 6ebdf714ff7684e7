"""Brake, steer, both, or make the best of it: a pure function of the encounter and the table of last points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

from fmus.planner.evasion.braking import impact_speed, stopping_distance
from fmus.planner.evasion.situation import Encounter, Surroundings, checked
from fmus.planner.evasion.table import LastPointTable

Action = Literal["brake", "steer", "brake and steer", "mitigate"]
ACTIONS: tuple[Action, ...] = ("brake", "steer", "brake and steer", "mitigate")
"""In order of preference; `Decision.code` is the place in it."""


@dataclass(frozen=True, slots=True)
class Decision:
    """What to do, and why: distance `left` when the manoeuvre begins and the last points [m], infinite where none is.

    The last point to brake includes the gap before the obstacle, those to steer the reserve.

    `impact` [m/s]: speed at the obstacle when it cannot be avoided, by the closed form; 0 for a stop within the gap.
    """

    action: Action
    left: float
    brake: float
    steer: float
    brake_and_steer: float
    impact: float

    @property
    def code(self) -> int:
        """0 brake, 1 steer, 2 brake and steer, 3 mitigate."""
        return ACTIONS.index(self.action)


def decide(encounter: Encounter, table: LastPointTable, surroundings: Surroundings | None = None) -> Decision:
    """The first action whose last point the car has not passed when the manoeuvre can begin.

    An obstacle beside which there is no room on the road can only be braked for. Raises PlanningError for an encounter
    that cannot be, or that the table does not hold.
    """
    s = surroundings or Surroundings()
    e = checked(encounter, s)
    left = e.distance - s.delay * e.speed
    last = {column: _last_point(table, column, e, s) for column in ("steer", "brake_and_steer")}
    last = {"brake": stopping_distance(e.speed, e.friction, s.deceleration) + s.standstill_gap, **last}
    action = next((name for name, way in zip(ACTIONS, last.values(), strict=False) if way <= left), ACTIONS[-1])
    impact = impact_speed(e.speed, e.friction, s.deceleration, max(left, 0.0)) if action == "mitigate" else 0.0
    return Decision(action, left, **last, impact=impact)


def _last_point(table: LastPointTable, column: str, e: Encounter, s: Surroundings) -> float:
    """An obstacle narrower than the table's is passed as the narrowest; too wide a one has no last point to steer."""
    offset = max(s.offset(e.width), float(table.offsets[0]))
    if offset > table.offsets[-1]:
        table.at(column, e.friction, float(table.offsets[-1]), e.speed)  # beyond the table in speed or friction
        return math.inf
    return s.reserve * table.at(column, e.friction, offset, e.speed)
