"""What a drive along a road planned while driving is worth."""

from __future__ import annotations

import csv

import numpy as np

from cosim.results import Results
from cosim.scenarios._arbitrary_path import built_in_road, clearance, optimum
from cosim.scenarios._mpc_metrics import mpc_metrics
from cosim.scenarios._tracking_metrics import peak
from cosim.slave import Vector

PLANNING = 0.0


def arbitrary_path_metrics(results: Results) -> dict[str, float]:
    """Times [s] and distances [m]; `optimum_*` and `corridor_*` are of the built-in road with the planner's limits."""
    driven, best = final_time(results), optimal_time(results)
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
        "corridor_violation_max": violation(results),
        **mpc_metrics(results, "planner"),
    }


def final_time(results: Results) -> float:
    """When O1 crossed the last gate of the built-in road inside the road [s], linear between two rows; else NaN."""
    gates = built_in_road(clearance({"margin": 0.0})).gates(2)
    x, y, heading = gates.frames[-1]
    away = np.column_stack([results["plant.position.x"] - x, results["plant.position.y"] - y])
    c, s = np.cos(heading), np.sin(heading)
    ahead, left = c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]
    crossed = (ahead[:-1] < 0) & (ahead[1:] >= 0) & (left[1:] >= gates.low[-1]) & (left[1:] <= gates.high[-1])
    if not crossed.any():
        return float("nan")
    rows = int(np.argmax(crossed)) + np.arange(2)
    return float(np.interp(0.0, ahead[rows], results.time[rows]))


def optimal_time(results: Results) -> float:
    """End time [s] of the global optimum."""
    with optimum(results.settings).open(newline="", encoding="utf-8") as source:
        return float(list(csv.DictReader(source))[-1]["time"])


def planned_ahead(results: Results) -> float:
    """The least time [s] planned ahead of now while there was more to plan."""
    planning = results.samples("planner", "plan.phase") == PLANNING
    ahead = results.samples("planner", "plan.end_time") - results.time[results.instants("planner")]
    return float(np.min(ahead[planning], initial=np.inf))


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


def violation(results: Results) -> float:
    """How far O1 left the road less the car's half width, before its end."""
    points = np.column_stack([results["plant.position.x"], results["plant.position.y"]])
    road = built_in_road(clearance({"margin": 0.0}))
    end, heading = road.gates(2).frames[-1, :2], road.gates(2).frames[-1, 2]
    before = (points - end) @ np.array([np.cos(heading), np.sin(heading)]) < 0
    return road.violation(points[before])


def last(results: Results, name: str) -> float:
    """The signal of the planner at its last sample."""
    return float(results.samples("planner", name)[-1])


def _mean(values: Vector) -> Vector:
    return np.asarray(0.5 * (values[1:] + values[:-1]))
