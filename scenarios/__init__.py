"""The scenarios, by family: each folder holds its systems, metrics and picture."""

from __future__ import annotations

from importlib import import_module

from cosim.errors import unknown
from cosim.scenario import Scenario

_MODULES = {
    "arbitrary-path": "arbitrary_path.scenario",
    "collision-avoidance": "collision_avoidance.scenario",
    "double-lane-change": "lane_change.planar",
    "double-lane-change-16dof": "lane_change.multibody",
    "formation-adaptive": "formation.adaptive",
    "formation-constraint": "formation.constraint",
    "high-speed-tracking": "tracking.high_speed",
    "lateral-tracking": "tracking.lateral",
    "longitudinal-tracking": "tracking.longitudinal",
    "motor-failure": "lane_change.motor_failure",
    "platoon": "platoon.scenario",
}


def names() -> list[str]:
    """The names of all scenarios."""
    return list(_MODULES)


def load(name: str) -> Scenario:
    """The scenario called `name`; raises CosimError with the closest names."""
    if name not in _MODULES:
        raise unknown("scenario", name, names())
    scenario: Scenario = import_module(f"{__name__}.{_MODULES[name]}").SCENARIO
    return scenario
