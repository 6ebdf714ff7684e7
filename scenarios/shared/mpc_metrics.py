"""How well MpcAllocator follows a trajectory and what its solvers did; errors of the plant's true states."""

from __future__ import annotations

import numpy as np

from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics, count, in_unit
from scenarios.shared.statistics import largest, peak, rms
from scenarios.shared.tracking_errors import tracking_errors

SOLVED = 1.0
RESIDUALS = {"force_x": "N", "force_y": "N", "moment_z": "N.m"}
"""Outputs `residual.*` of MpcAllocator with their units."""


def mpc_metrics(results: Results, source: str = "reference") -> Metrics:
    """Tracking, residuals of the distribution, and solvers; an error "after" a time is the largest from then on.

    `source` is the instance that gives the reference.
    """
    e = tracking_errors(results, source)
    distances = {
        "lateral_error_max": peak(e.lateral),
        "lateral_error_rms": rms(e.lateral),
        "lateral_error_after_0.5s": largest(e.lateral[e.time >= 0.5]),
        "lateral_error_after_2s": largest(e.lateral[e.time >= 2.0]),
        "lateral_error_rms_after_2s": rms(e.lateral[e.time >= 2.0]),
        "longitudinal_error_max": peak(e.longitudinal),
    }
    return {
        **in_unit("m", distances),
        "speed_error_max": Metric(peak(e.speed), "m/s"),
        "course_error_max": Metric(peak(e.course), "rad"),
        "sideslip_max": Metric(peak(results["plant.sideslip"]), "rad"),
        **residuals(results),
        **solvers(results),
    }


def residuals(results: Results) -> Metrics:
    """What the wheels give less what was wanted: RMS and largest."""
    found: dict[str, Metric] = {}
    for name, unit in RESIDUALS.items():
        values = results.samples("mpc", f"residual.{name}")
        found |= in_unit(unit, {f"residual_{name}_rms": rms(values), f"residual_{name}_max": peak(values)})
    return found


def solvers(results: Results) -> Metrics:
    """Samples each solver did not solve, its iterations, and how often an earlier plan was followed."""
    found: dict[str, Metric] = {}
    for name, prefix in (("solver", "mpc"), ("allocation", "allocation")):
        status, iterations = (results.samples("mpc", f"{name}.{what}") for what in ("status", "iterations"))
        found[f"{prefix}_unsolved"] = count(float(np.sum(status != SOLVED)))
        found[f"{prefix}_iterations_mean"] = Metric(float(np.mean(iterations)))
        found[f"{prefix}_iterations_max"] = count(peak(iterations))
    return found | {"fallback_count": count(peak(results.samples("mpc", "fallback.count")))}
