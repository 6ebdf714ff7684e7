"""Pass limits that several scenarios share; figures are engineering choices, wide enough for what is no accident."""

from __future__ import annotations

from cosim.scenario.limit import Limit

SPUN = Limit("spun", "sideslip_max", most=0.5)
"""[rad]: a car that slides at 29 degrees is not driven any more."""
SATURATED = Limit("an actuator stood at its limit", "saturation_longest", most=2.0)
"""[s] at a time."""
INCONSISTENT = (
    Limit("the filter is overconfident in position", "nis_position_mean", most=4.0),
    Limit("the filter is overconfident in heading", "nis_heading_mean", most=3.0),
)
"""Means of normalised innovations squared, 2 and 1 where the filter is consistent."""
LEFT_ROAD = Limit("left the road", "corridor_violation_max", most=0.05)
"""[m] beyond the corridor, which keeps a distance of its own from the edges."""


def off_path(most: float) -> Limit:
    """The car was further than `most` [m] beside the path it was to take."""
    return Limit("left its path", "lateral_error_max", most=most)
