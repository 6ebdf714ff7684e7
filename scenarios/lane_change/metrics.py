"""What a drive through the double lane change is worth: the metrics of MpcAllocator, the corridor, and the time."""

from __future__ import annotations

import numpy as np

from cosim.results.reading import Results
from scenarios.lane_change.loop import corridor
from scenarios.shared.mpc_metrics import largest, mpc_metrics
from scenarios.shared.tracking_errors import estimate_errors, longest_saturation, peak, rms

_AVAILABLE = "mpc.motor_available."


def lane_change_metrics(results: Results) -> dict[str, float]:
    """Metrics of a drive; times [s] and distances [m]."""
    return {"final_time": final_time(results), "corridor_violation_max": violation(results), **mpc_metrics(results)}


def multibody_metrics(results: Results) -> dict[str, float]:
    """The same, and what a planar car has not: attitude of the body, estimate, actuators of the low level."""
    error = estimate_errors(results)
    return lane_change_metrics(results) | {
        "roll_max": peak(results["plant.roll"]),
        "pitch_max": peak(results["plant.pitch"]),
        "position_estimate_rms": rms(np.hypot(error.x, error.y)),
        "yaw_estimate_rms": rms(error.yaw),
        "saturation_longest": longest_saturation(results),
    }


def motor_failure_metrics(results: Results) -> dict[str, float]:
    """The same, and what the distribution leaves over from the first sample on that knows of the failure."""
    known = results.instants("mpc")
    lost = np.any([results[name][known] < 1.0 for name in results.names if name.startswith(_AVAILABLE)], axis=0)
    found = {}
    for name in ("force_x", "force_y", "moment_z"):
        found[f"residual_{name}_max_after_failure"] = largest(results.samples("mpc", f"residual.{name}")[lost])
    return lane_change_metrics(results) | found


def final_time(results: Results) -> float:
    """When the car reached the end of the corridor, linear between two rows; NaN if it did not."""
    x, end = results["plant.position.x"], corridor().end
    beyond = np.flatnonzero(x >= end)
    if not len(beyond) or not beyond[0]:
        return float("nan")
    rows = [beyond[0] - 1, beyond[0]]
    return float(np.interp(end, x[rows], results.time[rows]))


def violation(results: Results) -> float:
    """How far O1 left the corridor between its ends, at most; NaN if it never was between them.

    The corridor keeps the clearance from its edges.
    """
    road = corridor()
    points = np.column_stack([results["plant.position.x"], results["plant.position.y"]])
    inside = (points[:, 0] >= road.start) & (points[:, 0] <= road.end)
    return road.violation(points[inside]) if inside.any() else float("nan")
