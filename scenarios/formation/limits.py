"""What a formation or a row of cars must keep to."""

from __future__ import annotations

from cosim.scenario.limit import Limit

LIMITS = (
    Limit("cars collided", "collision", most=0),
    Limit("a car lost its place", "formation_error_max", most=5.0),
)
"""The place in m: a car further away than its own length is not in the formation."""
