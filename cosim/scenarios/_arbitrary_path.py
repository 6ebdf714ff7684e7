"""A road planned while driving: RecedingHorizonPlanner, MpcAllocator and the planar car, which sees the true states."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.errors import CosimError
from cosim.face import Port, Value
from cosim.results import Results
from cosim.scenario import Settings
from cosim.scenarios._plans import planned
from cosim.scenarios._sensors import TRUE_STATES
from cosim.system import System
from cosim.values import coerce

if TYPE_CHECKING:
    from fmus.planner.path_road import PathRoad

_GRIP = 0.85
_LIMITS = {
    "limit.front_brake": 3000.0,
    "limit.rear_brake": 1500.0,
    "limit.sideslip": 0.08,
    "tyre.friction": 0.8,
}
"""The plan uses this part of the peak forces of the tyres, and less braking and sideslip than possible, so that the
controller can correct: the single-track car knows no load transfer, and brakes where it has no grip left to steer."""

INTERVALS = 69
"""Of the global optimum: as long as the gates of the planner are apart."""


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
    return float(_defaults()["road.clearance"]) + float(settings["margin"])


def planner_parameters(settings: Settings) -> dict[str, Any]:
    """What the scenario sets of the planner."""
    start = _defaults()
    peaks = {name: _GRIP * start[name] for name in ("design.tyre.front.peak", "design.tyre.rear.peak")}
    return {"road.clearance": clearance(settings), **_LIMITS, **peaks}


def start_beside_plan(system: System, settings: Settings) -> None:
    """The car starts where the planner does, `lateral_offset` to the left, unless told otherwise."""
    import numpy as np  # noqa: PLC0415  (lazy: `cosim list`)

    from fmus.planner.errors import PlanningError  # noqa: PLC0415
    from fmus.planner.receding import road, run  # noqa: PLC0415

    p = _defaults() | _checked(system.instances["planner"].parameters)
    try:
        start = run.start(p, road.read(p, _rows(p["road_file"])))
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


def optimum(settings: Settings) -> Path:
    """The time-optimal motion along the whole built-in road, with the limits of the planner, as a trajectory file."""
    from fmus.planner.program import standing_ends  # noqa: PLC0415
    from fmus.planner.receding import offline  # noqa: PLC0415

    p = offline.parameters(planner_parameters(settings))
    ends = standing_ends(p["initial.speed"])
    return planned("arbitrary-path", offline.same_limits(p), built_in_road(clearance(settings)), INTERVALS, ends)


def built_in_road(clearance: float) -> PathRoad:
    """The road of the planner without a file."""
    from fmus.planner.path_road import PathRoad  # noqa: PLC0415
    from fmus.planner.receding import built_in  # noqa: PLC0415

    rows = built_in.rows()
    return PathRoad(rows[:, :2], rows[:, 2:], clearance)


def draw(results: Results, file: Path, title: str) -> None:
    """overview.png."""
    from cosim.scenarios._arbitrary_path_overview import draw_overview  # noqa: PLC0415  (slow to import)

    draw_overview(results, file, title)


def _defaults() -> dict[str, Any]:
    from fmus.planner.receding import COMPONENT  # noqa: PLC0415

    return {variable.name: variable.start for variable in COMPONENT.interface.select("parameter")}


def _checked(given: Mapping[str, Value]) -> dict[str, Any]:
    """Values set of the planner as their types, in range: the road is laid before the FMU can check them."""
    from fmus.planner.receding import COMPONENT  # noqa: PLC0415

    ports = {
        v.name: Port(v.name, 0, v.causality, v.type, unit=v.unit, minimum=v.minimum, maximum=v.maximum)
        for v in COMPONENT.interface.select("parameter")
    }
    return {name: coerce("planner", ports[name], value) for name, value in given.items() if name in ports}


def _rows(file: str) -> list[list[float]]:
    """Rows of the road file; none without a file."""
    from fmus.planner.path_road import read_road  # noqa: PLC0415

    if not file:
        return []
    road = read_road(Path(file))
    rows: list[list[float]] = [[*point, *widths] for point, widths in zip(road.points, road.widths, strict=True)]
    return rows
