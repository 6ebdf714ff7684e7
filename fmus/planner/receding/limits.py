"""How hard the car can brake and turn by its own limits, with which the speed beyond a horizon must agree."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_ACROSS, _ALONG = 0.95, 0.9
"""Parts of what the car can do (engineering choice)."""


def lateral(p: Mapping[str, Any]) -> float:
    """a_y [m/s2]: `speed.lateral`, or less where the peak forces of the tyres allow less."""
    peaks = p["design.tyre.front.peak"] + p["design.tyre.rear.peak"]
    return float(min(p["speed.lateral"], _ACROSS * peaks / p["design.body.mass"]))


def braking(p: Mapping[str, Any]) -> float:
    """a_b [m/s2]: `speed.braking`, or less where the brakes, and with combined slip the friction, allow less."""
    arms = p["design.geometry.front_axle"], p["design.geometry.rear_axle"]
    weight = p["design.body.mass"] * p["design.gravity"]
    force = 0.0
    for axle, far in (("front", arms[1]), ("rear", arms[0])):
        grip = p["tyre.friction"] * weight * far / sum(arms) if p["tyre.combined_slip"] else float("inf")
        force += min(p[f"limit.{axle}_brake"], grip)
    return float(min(p["speed.braking"], _ALONG * force / p["design.body.mass"]))
