"""How well MpcAllocator follows a trajectory and what its solvers did; SI units, errors of the plant's true states."""

from __future__ import annotations

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.shared.statistics import peak, rms
from scenarios.shared.tracking_errors import tracking_errors

SOLVED = 1.0


def mpc_metrics(results: Results, source: str = "reference") -> dict[str, float]:
    """Tracking, residuals of the distribution, and solvers; an error "after" a time is the largest from then on."""
    e = tracking_errors(results, source)
    return {
        "lateral_error_max": peak(e.lateral),
        "lateral_error_rms": rms(e.lateral),
        "lateral_error_after_0.5s": largest(e.lateral[e.time >= 0.5]),
        "lateral_error_after_2s": largest(e.lateral[e.time >= 2.0]),
        "lateral_error_rms_after_2s": rms(e.lateral[e.time >= 2.0]),
        "longitudinal_error_max": peak(e.longitudinal),
        "speed_error_max": peak(e.speed),
        "course_error_max": peak(e.course),
        "sideslip_max": peak(results["plant.sideslip"]),
        **residuals(results),
        **solvers(results),
    }


def residuals(results: Results) -> dict[str, float]:
    """What the wheels give less what was wanted: RMS and largest."""
    found: dict[str, float] = {}
    for name in ("force_x", "force_y", "moment_z"):
        values = results.samples("mpc", f"residual.{name}")
        found |= {f"residual_{name}_rms": rms(values), f"residual_{name}_max": peak(values)}
    return found


def solvers(results: Results) -> dict[str, float]:
    """Samples each solver did not solve, its iterations, and how often an earlier plan was followed."""
    found: dict[str, float] = {}
    for name, prefix in (("solver", "mpc"), ("allocation", "allocation")):
        status, iterations = (results.samples("mpc", f"{name}.{what}") for what in ("status", "iterations"))
        found[f"{prefix}_unsolved"] = float(np.sum(status != SOLVED))
        found[f"{prefix}_iterations_mean"] = float(np.mean(iterations))
        found[f"{prefix}_iterations_max"] = peak(iterations)
    return found | {"fallback_count": peak(results.samples("mpc", "fallback.count"))}


def largest(values: Vector) -> float:
    """Largest magnitude; NaN without values."""
    return peak(values) if len(values) else float("nan")
