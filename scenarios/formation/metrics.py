"""How well followers keep their places: errors, changes of formation, effort, distances; true states, SI units.

What the errors are is said in `errors`; that of place is measured except while the place is being changed.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from cosim.scenario.metric import Metric, Metrics
from scenarios.formation.by_car import by_car, largest
from scenarios.formation.distances import distance_metrics
from scenarios.formation.errors import FollowerErrors, errors_of_followers
from scenarios.formation.string_stability import ratio_metrics
from scenarios.formation.timetable import Formation
from scenarios.shared.statistics import peak, rms

_SETTLED = 0.3
"""A change of formation is over when the hand point stays this near [m] to its new place (engineering choice)."""
_UNITS = {
    **dict.fromkeys(("formation_error_rms", "formation_error_max"), "m"),
    **dict.fromkeys(("position_error_rms", "position_error_max", "place_error_rms", "place_error_max"), "m"),
    **{"led_back_time": "s", "settling_time": "s", "change_error_max": "m"},
    **dict.fromkeys(("acceleration_rms", "lateral_acceleration_rms"), "m/s2"),
}
"""All figures of a follower."""
_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class ShapeChange:
    """How one change of formation went.

    `settling` [s] is NaN if the place was not reached before the next change or the end; `error` [m] is the largest
    until then.
    """

    settling: float
    error: float


def formation_metrics(results: Results, formation: Formation) -> Metrics:
    """How well every follower kept its place, how near cars came, and in a row whether errors grow from car to car."""
    warn_of_few_rows(results, formation.leaders)
    errors = errors_of_followers(results, formation.leaders)
    found = {**follower_metrics(results, errors), **distance_metrics(results, formation.cars)}
    if formation.in_a_row:
        found |= ratio_metrics({k: e.hand for k, e in errors.items()})
    return found


def follower_metrics(
    results: Results, errors: Mapping[int, FollowerErrors], changes_until: float = math.inf
) -> dict[str, Metric]:
    """Metrics per follower, `car2.formation_error_rms`, and the worst of all without a car's name.

    `errors` are by number of the follower. Changes of formation are looked at up to `changes_until` [s], when something
    else begins. NaN where there is nothing to measure: no follower, no change of formation.
    """
    return by_car({car: _figures(results, car, errors[car], changes_until) for car in sorted(errors)}, _UNITS)


def _figures(results: Results, car: int, e: FollowerErrors, changes_until: float) -> dict[str, float]:
    if len(e.time) < 2:
        return dict.fromkeys(_UNITS, math.nan)
    changes = shape_changes(e, changes_until)
    hand, position, place = (np.linalg.norm(z, axis=1) for z in (e.hand, e.position, e.place[~e.changing]))
    return {
        "formation_error_rms": rms(hand),
        "formation_error_max": peak(hand),
        "position_error_rms": rms(position),
        "position_error_max": peak(position),
        "place_error_rms": rms(place),
        "place_error_max": peak(place),
        "led_back_time": np.count_nonzero(e.led_back) * float(e.time[1] - e.time[0]),
        "settling_time": float(np.max([c.settling for c in changes])) if changes else math.nan,  # NaN if one is
        "change_error_max": largest(c.error for c in changes),
        "acceleration_rms": rms(results.samples(f"car{car}.follower", "command.acceleration")),
        "lateral_acceleration_rms": rms(_lateral_acceleration(results, car)),
    }


def shape_changes(e: FollowerErrors, until: float) -> list[ShapeChange]:
    """The changes of formation commanded up to `until` [s], each up to the next."""
    last = int(np.searchsorted(e.time, until))
    begins = e.jumps[e.jumps < last]
    far, size = np.linalg.norm(e.place, axis=1), np.linalg.norm(e.hand, axis=1)
    return [
        ShapeChange(settling(e.time[i:j], far[i:j], _SETTLED), peak(size[i:j]))
        for i, j in zip(begins, [*begins[1:], last], strict=False)  # no jump, no change
    ]


def settling(time: Vector, error: Vector, threshold: float) -> float:
    """Time [s] from the first row until the error stays below the threshold; NaN if it is above it at the end."""
    above = np.flatnonzero(np.abs(error) >= threshold)
    if not len(above):
        return 0.0
    return float(time[above[-1] + 1] - time[0]) if above[-1] + 1 < len(time) else math.nan


def warn_of_few_rows(results: Results, followers: Mapping[int, int]) -> None:
    """Say so when rows are recorded less often than the followers compute: what happens between them is not seen."""
    if not followers:
        return
    follower = f"car{min(followers)}.follower"
    rows, period = results.instants(follower), results.facts.periods[follower]
    every = float(np.diff(results.time[rows]).max()) if len(rows) > 1 else math.inf
    if every > 1.5 * period:
        seen = f"every {every:g} s" if len(rows) > 1 else "once"
        _LOG.warning("the metrics see followers %s only: record every %g s for ones that miss nothing", seen, period)


def _lateral_acceleration(results: Results, car: int) -> Vector:
    """v omega (n,) [m/s2] of the car at its follower's instants."""
    rows = results.instants(f"car{car}.follower")
    return np.asarray(results[f"car{car}.plant.velocity.x"][rows] * results[f"car{car}.plant.angular_rate.z"][rows])
