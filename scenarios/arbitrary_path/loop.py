"""A road planned while driving: RecedingHorizonPlanner, MpcAllocator and the planar car, which sees the true states."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from cosim.errors import CosimError
from cosim.model.system import System
from cosim.results.reading import Results
from cosim.scenario import Settings
from scenarios.arbitrary_path import road as _arbitrary_road
from scenarios.shared.sensors import TRUE_STATES

_GRIP = 0.85
_LIMITS = {
    "limit.front_brake": 3000.0,
    "limit.rear_brake": 1500.0,
    "limit.sideslip": 0.08,
    "tyre.friction": 0.8,
}
"""The plan uses this part of the peak forces of the tyres, and less braking and sideslip than possible, so that the
controller can correct: the single-track car knows no load transfer, and brakes where it has no grip left to steer."""


def loop(settings: Settings) -> System:
    """Planner, controller and car; longitudinal forces cost the car lateral ones, as the planner expects."""
    system = System()
    system.add("plant", "DoubleTrack", {"tyre.combined_slip": True})
    system.add("planner", "RecedingHorizonPlanner", planner_parameters(settings))
    system.add("mpc", "MpcAllocator")
    system.connect("plant", "planner", TRUE_STATES)
    system.connect("planner", "mpc")
    system.connect("plant", "mpc", TRUE_STATES)
    system.connect("mpc", "plant")
    return system


def clearance(settings: Settings) -> float:
    """Distance [m] the centre of gravity keeps from the edges."""
    return _arbitrary_road.half_width() + float(settings["margin"])


def planner_parameters(settings: Settings) -> dict[str, Any]:
    """What the scenario sets of the planner."""
    start = _arbitrary_road.defaults()
    peaks = {name: _GRIP * start[name] for name in ("design.tyre.front.peak", "design.tyre.rear.peak")}
    return {"road.clearance": clearance(settings), **_LIMITS, **peaks}


def start_beside_plan(system: System, settings: Settings) -> None:
    """The car starts where the planner does, `lateral_offset` to the left, unless told otherwise."""
    import numpy as np  # noqa: PLC0415  (lazy: `cosim list`)

    from fmus.planner.errors import PlanningError  # noqa: PLC0415
    from fmus.planner.receding import run  # noqa: PLC0415

    p = _arbitrary_road.parameters(system.instances["planner"].parameters)
    try:
        start = run.start(p, _arbitrary_road.gates(p))
    except (ValueError, PlanningError) as error:
        raise CosimError(f"planner: {error}") from None
    x, y, v, _, yaw, *_ = start.x[0]
    left = float(settings["lateral_offset"])
    values = {
        "initial.position.x": x - left * np.sin(yaw),
        "initial.position.y": y + left * np.cos(yaw),
        "initial.yaw": np.arctan2(np.sin(yaw), np.cos(yaw)),
        "initial.speed": v,
    }
    for name, value in values.items():
        system.instances["plant"].parameters.setdefault(name, float(value))


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from scenarios.arbitrary_path.picture import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)
