"""What a drive along a road planned while driving is worth."""

from __future__ import annotations

import csv
import logging
from collections.abc import Mapping
from typing import Any

import numpy as np

from cosim.errors import CosimError
from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.arbitrary_path import road as _arbitrary_road
from scenarios.shared.mpc_metrics import mpc_metrics
from scenarios.shared.tracking_errors import peak

PLANNING = 0.0
_ROUNDED = 1e-6  # [m/s], of speeds in a trajectory file
_LOG = logging.getLogger("cosim")


def arbitrary_path_metrics(results: Results) -> dict[str, float]:
    """Times [s] and distances [m], of the road and with the limits that the planner had in this run."""
    p = _arbitrary_road.parameters(results.parameters["planner"])
    end, driven = crossing(results, p)
    best = optimal_time(p)
    return {
        "final_time": driven,
        "final_time_planned": last(results, "plan.final_time") or float("nan"),
        "optimum_time": best,
        "optimum_ratio": driven / best,
        "problems": last(results, "problem.count"),
        "problems_failed": last(results, "problem.failed"),
        "fallbacks": last(results, "fallback.count"),
        "solver_iterations_max": peak(results.samples("planner", "solver.iterations")),
        "planned_ahead_min": planned_ahead(results),
        **joints(results),
        "corridor_violation_max": violation(results, p, end),
        **mpc_metrics(results, "planner"),
    }


def crossing(results: Results, p: Mapping[str, Any]) -> tuple[int, float]:
    """The first row after O1 crossed the last gate inside the road, and when [s], linear between two rows.

    All rows and NaN where it did not, or there is no last gate because the road is closed.
    """
    gates = _arbitrary_road.gates(p)
    x, y, heading = gates.frames[-1]
    away = np.column_stack([results["plant.position.x"] - x, results["plant.position.y"] - y])
    c, s = np.cos(heading), np.sin(heading)
    ahead, left = c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]
    more = p["road.clearance"] - _arbitrary_road.half_width()
    inside = (left >= gates.low[-1] - more) & (left <= gates.high[-1] + more)
    crossed = (ahead[:-1] < 0) & (ahead[1:] >= 0) & inside[1:]
    if gates.closed or not crossed.any():
        return len(ahead), float("nan")
    rows = int(np.argmax(crossed)) + np.arange(2)
    return int(rows[1]), float(np.interp(0.0, ahead[rows], results.time[rows]))


def optimal_time(p: Mapping[str, Any]) -> float:
    """End time [s] of the global optimum; NaN, and why in the log, where there is none to compare with."""
    try:
        if p["road.closed"]:
            raise CosimError("a closed road has no end")
        with _arbitrary_road.optimum(p).open(newline="", encoding="utf-8") as source:
            end = list(csv.DictReader(source))[-1]
        if float(end["speed"]) > p["end.speed"] + _ROUNDED:
            raise CosimError(f"it would pass the end at {float(end['speed']):.1f} m/s, faster than planner.end.speed")
    except CosimError as error:
        _LOG.info("optimum_time is unknown: %s", error)
        return float("nan")
    return float(end["time"])


def planned_ahead(results: Results) -> float:
    """The least time [s] planned ahead of now while there was more to plan; NaN without such a sample."""
    planning = results.samples("planner", "plan.phase") == PLANNING
    ahead = results.samples("planner", "plan.end_time") - results.time[results.instants("planner")]
    return float(np.min(ahead[planning])) if planning.any() else float("nan")


def joints(results: Results) -> dict[str, float]:
    """Jumps of the reference from sample to sample beyond what its own derivatives explain: m, rad, m/s."""
    x, y, course, speed, acceleration, curvature = (
        results.samples("planner", f"reference.{name}")
        for name in ("x", "y", "course", "speed", "acceleration", "curvature")
    )
    step = np.diff(results.time[results.instants("planner")])
    middle = 0.5 * (course[1:] + course[:-1])
    along = 0.5 * (speed[1:] + speed[:-1]) * step
    position = np.hypot(np.diff(x) - along * np.cos(middle), np.diff(y) - along * np.sin(middle))
    turn = np.diff(course) - _mean(speed * curvature) * step
    gain = np.diff(speed) - _mean(acceleration) * step
    return {"joint_position_max": peak(position), "joint_course_max": peak(turn), "joint_speed_max": peak(gain)}


def violation(results: Results, p: Mapping[str, Any], end: int) -> float:
    """How far O1 left the road less the car's half width, before row `end`."""
    points = np.column_stack([results["plant.position.x"], results["plant.position.y"]])
    return _arbitrary_road.path_road(p, _arbitrary_road.half_width()).violation(points[:end])


def last(results: Results, name: str) -> float:
    """The signal of the planner at its last sample."""
    return float(results.samples("planner", name)[-1])


def _mean(values: Vector) -> Vector:
    return np.asarray(0.5 * (values[1:] + values[:-1]))
