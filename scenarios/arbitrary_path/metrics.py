"""What a drive along a road planned while driving is worth."""

from __future__ import annotations

import logging
import math

import numpy as np

from cosim.errors import CosimError
from cosim.model.signals import Vector
from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics, count, truth
from fmus.controllers.reference.interface import INTERFACE as REFERENCE
from fmus.planner.receding.memory import BRAKED, PLANNING
from scenarios.arbitrary_path.road import LaidRoad
from scenarios.shared.mpc_metrics import mpc_metrics
from scenarios.shared.statistics import peak
from scenarios.shared.tables import read_columns

_INSET = 0.3  # [m], by which gates may be narrower than the road
_ROUNDED = 1e-6  # [m/s], of speeds in a trajectory file
_LOG = logging.getLogger("cosim")


def arbitrary_path_metrics(results: Results, laid: LaidRoad) -> Metrics:
    """Metrics of the road and with the limits that the planner had in this run."""
    end, driven = crossing(results, laid)
    best = optimal_time(laid) if math.isfinite(driven) else math.nan  # planning it takes longer than a short run
    return {
        "final_time": Metric(driven, "s"),
        "final_time_planned": Metric(last(results, "plan.final_time") or math.nan, "s"),
        "optimum_time": Metric(best, "s"),
        "optimum_ratio": Metric(driven / best),
        "problems": count(last(results, "problem.count")),
        "problems_failed": count(last(results, "problem.failed")),
        "fallbacks": count(last(results, "fallback.count")),
        "planner_gave_up": truth(last(results, "plan.phase") == BRAKED),
        "solver_iterations_max": count(peak(results.samples("planner", "solver.iterations"))),
        "planned_ahead_min": Metric(planned_ahead(results), "s"),
        **joints(results),
        "corridor_violation_max": Metric(violation(results, laid, end), "m"),
        **mpc_metrics(results, "planner"),
    }


def given_up(results: Results, laid: LaidRoad) -> str:
    """What became of a run whose planner gave up; empty if it did not."""
    if last(results, "plan.phase") != BRAKED:
        return ""
    phase, status = results.samples("planner", "plan.phase"), last(results, "solver.status")
    when = results.time[results.instants("planner")][int(np.argmax(phase == BRAKED))]
    return (
        f"the planner gave up at {when:.1f} s: {last(results, 'plan.distance'):.0f} m along the road, of "
        f"{laid.gates.at[-1]:.0f} m, a local problem had no solution (solver.status {status:.0f}), and the car was "
        "braked to a stop; give the car more force, another start or a smaller planner.road.spacing"
    )


def crossing(results: Results, laid: LaidRoad) -> tuple[int, float]:
    """The first row after O1 crossed the last gate inside the road, and when [s], linear between two rows.

    On a closed road, the first gate after half a lap at least. All rows and NaN where it did not.
    """
    gates = laid.gates
    x, y, heading = gates.frames[-1]
    away = np.column_stack([results["plant.position.x"] - x, results["plant.position.y"] - y])
    c, s = np.cos(heading), np.sin(heading)
    ahead, left = c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]
    more = laid.parameters["road.clearance"] - laid.half_width + _INSET
    inside = (left >= gates.low[-1] - more) & (left <= gates.high[-1] + more)
    crossed = (ahead[:-1] < 0) & (ahead[1:] >= 0) & inside[1:]
    if gates.closed:
        crossed &= np.cumsum(np.hypot(*np.diff(away, axis=0).T)) > 0.5 * gates.at[-1]
    if not crossed.any():
        return len(ahead), math.nan
    rows = int(np.argmax(crossed)) + np.arange(2)
    return int(rows[1]), float(np.interp(0.0, ahead[rows], results.time[rows]))


def optimal_time(laid: LaidRoad) -> float:
    """End time [s] of the global optimum; NaN, and why in the log, where there is none to compare with."""
    try:
        end = {name: float(column[-1]) for name, column in read_columns(str(laid.optimum()), REFERENCE).items()}
        if not laid.gates.closed and end["speed"] > laid.parameters["end.speed"] + _ROUNDED:
            raise CosimError(f"it would pass the end at {end['speed']:.1f} m/s, faster than planner.end.speed")
    except CosimError as error:
        _LOG.info("optimum_time is unknown: %s", error)
        return math.nan
    return end["time"]


def planned_ahead(results: Results) -> float:
    """The least time [s] planned ahead of now while there was more to plan; NaN without such a sample."""
    planning = results.samples("planner", "plan.phase") == PLANNING
    ahead = results.samples("planner", "plan.end_time") - results.time[results.instants("planner")]
    return float(np.min(ahead[planning])) if planning.any() else math.nan


def joints(results: Results) -> Metrics:
    """Jumps of the reference from sample to sample beyond what its own derivatives explain."""
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
    return {
        "joint_position_max": Metric(peak(position), "m"),
        "joint_course_max": Metric(peak(turn), "rad"),
        "joint_speed_max": Metric(peak(gain), "m/s"),
    }


def violation(results: Results, laid: LaidRoad, end: int) -> float:
    """How far [m] O1 left the road less the car's half width, before row `end`."""
    points = np.column_stack([results["plant.position.x"], results["plant.position.y"]])
    return laid.drivable.violation(points[:end])


def last(results: Results, name: str) -> float:
    """The signal of the planner at its last sample."""
    return float(results.samples("planner", name)[-1])


def _mean(values: Vector) -> Vector:
    return np.asarray(0.5 * (values[1:] + values[:-1]))
