"""Whether disturbances grow along a platoon: each event is looked at by itself."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.distances import distance_metrics
from scenarios.formation.metrics import Errors, follower_errors, formation_metrics, warn_of_few_rows
from scenarios.formation.scenario import leaders
from scenarios.formation.string_stability import gain_metrics, ratio_metrics, speed_ratios
from scenarios.formation.system import HEAD
from scenarios.platoon import system
from scenarios.platoon.excitation import LINES, PERIOD
from scenarios.platoon.row import SPEED
from scenarios.shared.tracking_errors import peak

_INSTANT = 1e-6  # s
_OFTEN = 8  # samples in a period of the fastest line


def platoon_metrics(results: Results) -> dict[str, float]:
    """Metrics in SI units; ratios are those while the head brakes and accelerates, gains those of the sweep.

    NaN where a run ended before what is measured was over.
    """
    follows = leaders(results.settings)
    warn_of_few_rows(results, follows)
    errors = {k: follower_errors(results, k, leader) for k, leader in follows.items()}
    return {
        **formation_metrics(results, follows, changes_until=system.span(results.settings, "merge")[1]),
        **distance_metrics(results, (HEAD, *follows)),
        **_pushed(results, errors),
        **_ratios(results, errors),
        **_gains(results, errors),
    }


def _pushed(results: Results, errors: Mapping[int, Errors]) -> dict[str, float]:
    """Largest error of the pushed car, of all before and of all behind it, until it has died out."""
    if not system.happens(results.settings, "push"):
        return {}
    begin, end = system.span(results.settings, "push")
    if not _over(results, end):
        errors = {}
    sizes = {k: peak(during(results, e, begin, end)[:, 0]) for k, e in errors.items()}
    car = system.pushed(results.settings)
    return {
        "push_error_max": sizes.get(car, math.nan),
        "push_error_ahead_max": max((v for k, v in sizes.items() if k < car), default=math.nan),
        "push_error_behind_max": max((v for k, v in sizes.items() if k > car), default=math.nan),
    }


def _ratios(results: Results, errors: Mapping[int, Errors]) -> dict[str, float]:
    if not system.happens(results.settings, "braking"):
        return {}
    begin, end = system.span(results.settings, "braking")
    rows = (results.time >= begin - _INSTANT) & (results.time < end - _INSTANT) & _over(results, end)
    speeds = {k: results[f"car{k}.plant.velocity.x"][rows] - SPEED for k in (HEAD, *errors)}
    found = ratio_metrics({k: during(results, e, begin, end) for k, e in errors.items()})
    return {**found, **speed_ratios(speeds)}


def response_ratios(results: Results, quiet: Results) -> dict[str, float]:
    """The ratios of a braking alone, of errors less those of the run `quiet` with the same seed where nothing happens.

    The noise of sensors and radios is the same in both and drops out, as far as it does not depend on the motion.
    """
    begin, end = system.span({"manoeuvre": "braking"}, "braking")

    def errors(run: Results) -> dict[int, Vector]:
        follows = leaders(run.settings)
        return {k: during(run, follower_errors(run, k, leader), begin, end) for k, leader in follows.items()}

    disturbed, calm = errors(results), errors(quiet)
    return ratio_metrics({k: disturbed[k] - calm[k] for k in disturbed})


def _gains(results: Results, errors: Mapping[int, Errors]) -> dict[str, float]:
    """Amplification by frequency: of speeds from car 2 on, of errors from car 3 on; NaN where the rows are too few or
    do not fill the periods evenly."""
    if not system.happens(results.settings, "sweep"):
        return {}
    periods = round((system.END - system.SETTLED) / PERIOD)
    rows = results.instants(f"car{max(errors)}.follower") if errors else np.zeros(0, int)
    rows = rows[results.time[rows] >= system.SETTLED - _INSTANT]
    if not _over(results, system.END) or not _even(results.time[rows], periods * PERIOD):
        return gain_metrics({}, {}, LINES, periods)
    late = {k: during(results, e, system.SETTLED, system.END)[:, 0] for k, e in errors.items()}
    speeds = {k: np.asarray(results[f"car{k}.plant.velocity.x"][rows]) for k in (HEAD, *errors)}
    return gain_metrics(late, speeds, LINES, periods)


def _even(time: Vector, span: float) -> bool:
    """Whether times (n,) are even, often enough for the fastest line, and would begin anew after `span` [s]."""
    steps = np.diff(time, append=time[0] + span) if len(time) else np.zeros(1)
    return bool(len(time) >= _OFTEN * max(LINES) * span / PERIOD and np.ptp(steps) < _INSTANT)


def during(results: Results, e: Errors, begin: float, end: float) -> Vector:
    """z (n, 2) [m] of the hand point from `begin` to before `end` [s]; empty when the run ended earlier."""
    within = (e.time >= begin - _INSTANT) & (e.time < end - _INSTANT)
    return e.hand[within & _over(results, end)]


def _over(results: Results, end: float) -> bool:
    return bool(results.time[-1] >= end - _INSTANT)
