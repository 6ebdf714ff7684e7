"""A road planned while driving: RecedingHorizonPlanner, MpcAllocator and the planar car, which sees the true states."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.errors import CosimError, because
from cosim.results import Results
from cosim.scenario import Settings
from cosim.scenarios._plans import planned
from cosim.system import System

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
_TRUTH = {"estimate.": "", "estimate.yaw_rate": "angular_rate.z"}


def loop(settings: Settings) -> System:
    """Planner, controller and car; longitudinal forces cost the car lateral ones, as the planner expects."""
    system = System()
    system.add("plant", "DoubleTrack", {"tyre.combined_slip": True})
    system.add("planner", "RecedingHorizonPlanner", planner_parameters(settings))
    system.add("mpc", "MpcAllocator")
    system.connect("plant", "planner", _TRUTH)
    system.connect("planner", "mpc")
    system.connect("plant", "mpc", _TRUTH)
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

    from fmus.planner.receding import road, run  # noqa: PLC0415

    p = _defaults() | _typed(system.instances["planner"].parameters)
    try:
        start = run.start(p, road.read(p, _rows(Path(p["road_file"])) if p["road_file"] else []))
    except ValueError as error:
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


def _typed(given: Any) -> dict[str, Any]:
    """Values set by hand may be text; what is not a number is refused where it is set."""
    start = _defaults()
    found: dict[str, Any] = {}
    for name, value in given.items():
        if isinstance(start.get(name), bool):
            found[name] = str(value).lower() in ("true", "1", "1.0")
        elif isinstance(start.get(name), float):
            found[name] = _number(name, value)
        else:
            found[name] = value
    return found


def _number(name: str, value: Any) -> float:
    try:
        return float(value)
    except ValueError:
        raise CosimError(f"planner.{name} = {value!r} is not a number") from None


def _rows(file: Path) -> list[list[float]]:
    try:
        with file.open(newline="", encoding="utf-8-sig") as source:
            return [[float(cell) for cell in row] for row in list(csv.reader(source))[1:] if row]
    except OSError as error:
        raise CosimError(f"cannot read the road {file}: {because(error)}") from None
    except (ValueError, csv.Error) as error:
        raise CosimError(f"the road {file} is not made of numbers: {error}") from None
