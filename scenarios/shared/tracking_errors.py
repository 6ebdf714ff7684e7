"""Errors of a car that follows a reference and of its estimate, on true states of the plant at O1, in SI units.

Errors are taken only at the instants at which the reference, or the filter, computed: in between they hold.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.shared.statistics import wrap


@dataclass(frozen=True, slots=True)
class TrackingErrors:
    """Plant minus reference at the reference's instants; positions in the path frame of the reference at that time."""

    time: Vector
    longitudinal: Vector
    lateral: Vector
    speed: Vector
    course: Vector


@dataclass(frozen=True, slots=True)
class EstimateErrors:
    """Estimate minus plant at the filter's instants."""

    time: Vector
    x: Vector
    y: Vector
    yaw: Vector


def tracking_errors(results: Results, source: str = "reference") -> TrackingErrors:
    """e = R(chi_r)^T (p - p_r), e_v = |v| - v_r, e_chi = yaw + beta - chi_r wrapped.

    `source` is the instance that gives the reference.
    """
    rows = results.instants(source)

    def at(name: str) -> Vector:
        return results[name][rows]

    course = at(f"{source}.reference.course")
    dx = at("plant.position.x") - at(f"{source}.reference.x")
    dy = at("plant.position.y") - at(f"{source}.reference.y")
    return TrackingErrors(
        time=results.time[rows],
        longitudinal=np.cos(course) * dx + np.sin(course) * dy,
        lateral=-np.sin(course) * dx + np.cos(course) * dy,
        speed=np.hypot(at("plant.velocity.x"), at("plant.velocity.y")) - at(f"{source}.reference.speed"),
        course=wrap(at("plant.yaw") + at("plant.sideslip") - course),
    )


def estimate_errors(results: Results) -> EstimateErrors:
    rows = results.instants("filter")

    def error(name: str) -> Vector:
        return np.asarray(results[f"filter.estimate.{name}"][rows] - results[f"plant.{name}"][rows])

    return EstimateErrors(results.time[rows], error("position.x"), error("position.y"), wrap(error("yaw")))


def new_fixes(results: Results, name: str) -> Vector:
    """The values of a filter signal at those of its instants that processed a fix not seen before."""
    rows = results.instants("filter")
    count = results["gps.gps.fix_count"][rows]
    return np.asarray(results[name][rows[1:][np.diff(count) > 0.5]])


def longest_saturation(results: Results) -> float:
    """The longest time [s] any one actuator of the low-level controller stayed at its limit."""
    names = [name for name in results.names if name.startswith("llc.saturation.")]
    return max((_longest(results.time, results[name] > 0.5) for name in names), default=0.0)


def _longest(time: Vector, active: np.ndarray) -> float:
    edges = np.diff(np.concatenate(([False], active, [False])).astype(int))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    ends = np.minimum(ends, len(time) - 1)
    return float(np.max(time[ends] - time[starts], initial=0.0))
