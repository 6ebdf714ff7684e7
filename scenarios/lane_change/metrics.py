"""What a drive through the double lane change is worth: the metrics of MpcAllocator, the corridor, and the time."""

from __future__ import annotations

import math

import numpy as np

from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics
from fmus.cars.wheels import WHEELS
from fmus.planner.road import Corridor
from scenarios.lane_change.plan import LaneChange
from scenarios.shared.mpc_metrics import RESIDUALS, mpc_metrics
from scenarios.shared.statistics import largest, peak, rms
from scenarios.shared.tracking_errors import estimate_errors, longest_saturation

_AVAILABLE = "plant.motor_available."
"""How the inputs begin that say whether a motor works; recorded are those that change."""


def lane_change_metrics(results: Results, change: LaneChange) -> Metrics:
    """Metrics of a drive; those of the corridor only of a drive through it."""
    corridor = change.corridor
    return {
        "final_time": Metric(final_time(results, corridor) if corridor else math.nan, "s"),
        "corridor_violation_max": Metric(violation(results, corridor) if corridor else math.nan, "m"),
        **mpc_metrics(results),
    }


def multibody_metrics(results: Results, change: LaneChange) -> Metrics:
    """The same, and what a planar car has not: attitude of the body, estimate, actuators of the low level."""
    error = estimate_errors(results)
    return {
        **lane_change_metrics(results, change),
        "roll_max": Metric(peak(results["plant.roll"]), "rad"),
        "pitch_max": Metric(peak(results["plant.pitch"]), "rad"),
        "position_estimate_rms": Metric(rms(np.hypot(error.x, error.y)), "m"),
        "yaw_estimate_rms": Metric(rms(error.yaw), "rad"),
        "saturation_longest": Metric(longest_saturation(results), "s"),
    }


def motor_failure_metrics(results: Results, change: LaneChange) -> Metrics:
    """The same, when the failure was known, and what the distribution leaves over from then on."""
    lost = np.any([results.samples("mpc", f"motor_lost.{wheel}") > 0.0 for wheel in WHEELS], axis=0)
    failed = np.any([results[name] < 1.0 for name in results.names if name.startswith(_AVAILABLE)], axis=0)
    left = {
        f"residual_{name}_max_after_failure": Metric(largest(results.samples("mpc", f"residual.{name}")[lost]), unit)
        for name, unit in RESIDUALS.items()
    }
    known = _first(results.time[results.instants("mpc")], lost) - _first(results.time, failed)
    return {**lane_change_metrics(results, change), **left, "failure_known_after": Metric(known, "s")}


def _first(times: np.ndarray, true: np.ndarray) -> float:
    """The first of the times [s] at which something is true; NaN if it never is."""
    return float(times[true][0]) if np.any(true) else math.nan


def final_time(results: Results, corridor: Corridor) -> float:
    """When [s] the car reached the end of the corridor, linear between two rows; NaN if it did not."""
    x, end = results["plant.position.x"], corridor.end
    beyond = np.flatnonzero(x >= end)
    if not len(beyond) or not beyond[0]:
        return math.nan
    rows = [beyond[0] - 1, beyond[0]]
    return float(np.interp(end, x[rows], results.time[rows]))


def violation(results: Results, corridor: Corridor) -> float:
    """How far [m] O1 left the corridor between its ends, at most; NaN if it never was between them.

    The corridor keeps the clearance from its edges.
    """
    points = np.column_stack([results["plant.position.x"], results["plant.position.y"]])
    inside = (points[:, 0] >= corridor.start) & (points[:, 0] <= corridor.end)
    return corridor.violation(points[inside]) if inside.any() else math.nan
