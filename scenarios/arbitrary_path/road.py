"""The road of arbitrary-path and the fastest motion along it, as its planner has them: also what is set by hand."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cosim.model.face import Port, Value
from cosim.model.values import coerce
from scenarios.shared.plans import planned

if TYPE_CHECKING:
    from fmus.planner.path_road import PathRoad
    from fmus.planner.receding.road import GatedRoad


def defaults() -> dict[str, Any]:
    """Start values of the planner."""
    from fmus.planner.receding import COMPONENT  # noqa: PLC0415  (lazy: `cosim list`)

    return {variable.name: variable.start for variable in COMPONENT.interface.select("parameter")}


def parameters(given: Mapping[str, Value]) -> dict[str, Any]:
    """All parameters of the planner, those given in range: the road is laid before the FMU can check them."""
    from fmus.planner.receding import COMPONENT  # noqa: PLC0415

    ports = {
        v.name: Port(v.name, 0, v.causality, v.type, unit=v.unit, minimum=v.minimum, maximum=v.maximum)
        for v in COMPONENT.interface.select("parameter")
    }
    return defaults() | {name: coerce("planner", ports[name], given[name]) for name in given if name in ports}


def half_width() -> float:
    """Distance [m] the centre of gravity must keep from the edges of the road."""
    return float(defaults()["road.clearance"])


def gates(p: Mapping[str, Any]) -> GatedRoad:
    """The gates of the planner; raises ValueError or PlanningError naming what is wrong with the road."""
    from fmus.planner.receding import road  # noqa: PLC0415

    return road.read(p, _rows(p["road_file"]))


def path_road(p: Mapping[str, Any], clearance: float) -> PathRoad:
    """The road to measure and draw, `clearance` [m] kept from its edges."""
    import numpy as np  # noqa: PLC0415

    from fmus.planner.path_road import PathRoad  # noqa: PLC0415
    from fmus.planner.receding import built_in  # noqa: PLC0415

    rows = np.array(_rows(p["road_file"]) or built_in.rows())
    return PathRoad(rows[:, :2], rows[:, 2:], clearance, p["road.closed"])


def optimum(p: Mapping[str, Any]) -> Path:
    """The time-optimal motion with car, limits and gates of the planner, as a trajectory file.

    It starts anywhere across the road and ends at any speed. Raises CosimError when there is none.
    """
    from fmus.planner.program import standing_ends  # noqa: PLC0415
    from fmus.planner.receding import offline  # noqa: PLC0415

    ends = standing_ends(p["initial.speed"])
    ends.first[4] = p["initial.heading"]
    road = path_road(p, p["road.clearance"])
    return planned("arbitrary-path", offline.same_limits(p), road, gates(p).last, ends)


def _rows(file: str) -> list[list[float]]:
    """Rows of the road file; none without a file."""
    from fmus.planner.path_road import read_road  # noqa: PLC0415

    if not file:
        return []
    road = read_road(Path(file))
    return [[*point, *widths] for point, widths in zip(road.points, road.widths, strict=True)]
