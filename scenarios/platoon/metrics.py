"""Whether disturbances grow along a platoon: each event is looked at by itself, on true states, in SI units."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics, in_unit
from scenarios.formation.by_car import largest
from scenarios.formation.distances import distance_metrics
from scenarios.formation.errors import FollowerErrors, errors_of_followers
from scenarios.formation.metrics import follower_metrics, warn_of_few_rows
from scenarios.formation.string_stability import gain_metrics, ratio_metrics, speed_ratio_metrics
from scenarios.formation.topology import HEAD
from scenarios.platoon.events import Span
from scenarios.platoon.excitation import LINES, PERIOD
from scenarios.platoon.prepare import Platoon
from scenarios.platoon.row import SPEED
from scenarios.shared.statistics import peak

_INSTANT = 1e-6  # s
_OFTEN = 8  # samples in a period of the fastest line
Errors = Mapping[int, FollowerErrors]


def platoon_metrics(results: Results, platoon: Platoon) -> Metrics:
    """Ratios are those while the head brakes and accelerates, gains those of the sweep.

    NaN where a run ended before what is measured was over.
    """
    warn_of_few_rows(results, platoon.leaders)
    errors = errors_of_followers(results, platoon.leaders)
    found: dict[str, Metric] = {}
    if "push" in platoon.events:
        found |= _of_push(results, errors, platoon.events["push"], platoon.pushed)
    if "braking" in platoon.events:
        found |= _of_braking(results, errors, platoon.events["braking"])
    if "sweep" in platoon.events:
        found |= _of_sweep(results, errors, platoon.events["sweep"])
    return {
        **follower_metrics(results, errors, platoon.changes_until),
        **distance_metrics(results, platoon.formation.cars),
        **found,
    }


def _of_push(results: Results, errors: Errors, span: Span, pushed: int) -> dict[str, Metric]:
    """Largest error of the pushed car, of all before and of all behind it, until it has died out."""
    measured = errors if _over(results, span) else {}
    sizes = {k: peak(during(results, e, span)[:, 0]) for k, e in measured.items()}
    return in_unit(
        "m",
        {
            "push_error_max": sizes.get(pushed, math.nan),
            "push_error_ahead_max": largest(size for k, size in sizes.items() if k < pushed),
            "push_error_behind_max": largest(size for k, size in sizes.items() if k > pushed),
        },
    )


def _of_braking(results: Results, errors: Errors, span: Span) -> dict[str, Metric]:
    rows = _within(results.time, span) & _over(results, span)
    speeds = {k: results[f"car{k}.plant.velocity.x"][rows] - SPEED for k in (HEAD, *errors)}
    return {**ratio_metrics({k: during(results, e, span) for k, e in errors.items()}), **speed_ratio_metrics(speeds)}


def _of_sweep(results: Results, errors: Errors, span: Span) -> dict[str, Metric]:
    """Amplification by frequency: of speeds from car 2 on, of errors from car 3 on, in the last period of the sweep.

    By then the answer has become periodic. NaN where the rows are too few or do not fill that period evenly.
    """
    last = Span(span.end - PERIOD, span.end)
    rows = results.instants(f"car{max(errors)}.follower") if errors else np.zeros(0, int)
    rows = rows[results.time[rows] >= last.begin - _INSTANT]
    if not _over(results, last) or not fill_a_period(results.time[rows]):
        return gain_metrics({}, {}, LINES, 1)
    late = {k: during(results, e, last)[:, 0] for k, e in errors.items()}
    speeds = {k: np.asarray(results[f"car{k}.plant.velocity.x"][rows]) for k in (HEAD, *errors)}
    return gain_metrics(late, speeds, LINES, 1)


def fill_a_period(time: Vector) -> bool:
    """Whether times (n,) [s] are even, often enough for the fastest line, and would begin anew after one period."""
    steps = np.diff(time, append=time[0] + PERIOD) if len(time) else np.zeros(1)
    return bool(len(time) >= _OFTEN * max(LINES) and np.ptp(steps) < _INSTANT)


def during(results: Results, e: FollowerErrors, span: Span) -> Vector:
    """z (n, 2) [m] of the hand point from the begin to before the end of the span; empty when the run ended earlier."""
    return e.hand[_within(e.time, span) & _over(results, span)]


def _within(time: Vector, span: Span) -> np.ndarray:
    """Where (n,) the times [s] are in the span."""
    return (time >= span.begin - _INSTANT) & (time < span.end - _INSTANT)


def _over(results: Results, span: Span) -> bool:
    """Whether the run went on to the end of the span."""
    return bool(results.time[-1] >= span.end - _INSTANT)
