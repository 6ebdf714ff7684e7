"""How well followers keep their places: errors, changes of formation, effort, distances; true states, SI units.

`leaders` says who follows whom: {2: 1, 3: 2} is a chain of three cars. The error of a follower is that of its hand
point, which is what is controlled, in its own axes, actual minus desired:

    z = R(psi_i)^T (p_i - p_L - R(psi_L) r),   p_i = O1_i + a (cos psi_i, sin psi_i),   r = offset + (a, 0)

p_L and psi_L are the leader's true pose now, not what the radio last said; the offset is the one wanted now, as the
follower gives it. With a = 0 it is the error of O1, which in a bend is not zero for a follower without error. A
follower far from its place may lead itself back along an offset of its own; how far it then is from the place commanded
is the error of place, measured except while that place is being changed.
Errors are taken at the instants at which the follower computed.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.course import course, jumps, wanted
from scenarios.shared.tracking_errors import peak, rms

HAND = 6.0
"""Start value of the followers' `hand.distance` [m]."""
DURATION = 6.0
"""Start value of their `formation.duration` [s]."""
SETTLED = 0.3
"""A change of formation is over when the hand point stays this near [m] to its new place (engineering choice)."""
_LOG = logging.getLogger("cosim")


@dataclass(frozen=True, slots=True)
class Errors:
    """Of one follower at its instants: z (n, 2) [m] of the hand point, of O1, and `place`, that of the hand point to
    the place commanded, which a change of formation moves at once; `led_back` where (n,) it led itself back."""

    time: Vector
    hand: Vector
    position: Vector
    place: Vector
    led_back: np.ndarray


@dataclass(frozen=True, slots=True)
class Change:
    """One change of formation: `settling` [s], NaN if the place was not reached before the next change or the end, and
    the largest error [m] until then."""

    begin: float
    settling: float
    error: float


def formation_metrics(
    results: Results, leaders: Mapping[int, int], begin: float = 0.0, changes_until: float = math.inf
) -> dict[str, float]:
    """Metrics per follower, `car2.formation_error_rms`, and the worst of all without a car's name; from `begin` [s] on.

    Changes of formation are looked at up to `changes_until` [s], when something else begins.

    NaN where there is nothing to measure: no follower, no change of formation.
    """
    of_car = {car: _of_follower(results, car, leaders[car], begin, changes_until) for car in sorted(leaders)}
    names = next(iter(of_car.values()), dict.fromkeys(_NAMES, math.nan))
    worst = {name: _worst([metrics[name] for metrics in of_car.values()]) for name in names}
    singles = {f"car{car}.{name}": value for car, metrics in of_car.items() for name, value in metrics.items()}
    return {**worst, **singles}


_NAMES = (
    *("formation_error_rms", "formation_error_max", "position_error_rms", "position_error_max"),
    *("place_error_rms", "place_error_max", "led_back_time"),
    *("settling_time", "change_error_max", "acceleration_rms", "lateral_acceleration_rms"),
)


def _of_follower(results: Results, car: int, leader: int, begin: float, changes_until: float) -> dict[str, float]:
    e = follower_errors(results, car, leader)
    if len(e.time) < 2:
        return dict.fromkeys(_NAMES, math.nan)
    late = e.time >= begin
    controlled, position = (np.linalg.norm(z[late], axis=1) for z in (e.hand, e.position))
    command = commanded(results, car)
    changes = [c for c in formation_changes(e, command, until=changes_until) if c.begin >= begin]
    there = late & settled_command(e.time, command, _told(results, car, "formation.duration", DURATION))
    values = (
        *(rms(controlled), peak(controlled), rms(position), peak(position)),
        *(measure(np.linalg.norm(e.place[there], axis=1)) for measure in (rms, peak)),
        np.count_nonzero(e.led_back & late) * float(e.time[1] - e.time[0]),
        *(_worst([c.settling for c in changes], unknown=True), _worst([c.error for c in changes])),
        *(rms(values[late]) for values in efforts(results, car)),
    )
    return dict(zip(_NAMES, values, strict=True))


def follower_errors(results: Results, car: int, leader: int) -> Errors:
    """The errors of `car`, which follows `leader`; hand and headway are those its follower was told."""
    hand, headway = _told(results, car, "hand.distance", HAND), _told(results, car, "headway", 0.0)
    rows = results.instants(f"car{car}.follower")
    own, ahead = pose(results, car, rows), pose(results, leader, rows)
    time, speed, command = results.time[rows], _speed(results, car, rows), commanded(results, car)
    moving = course(time, command, _told(results, car, "formation.duration", DURATION))
    offset, led_back = wanted(time, offsets(results, car), moving, speed, headway)
    place = command - headway * np.stack((speed, 0 * speed), -1)
    return Errors(
        time=time,
        hand=error(own, ahead, offset, hand),
        position=error(own, ahead, offset, 0.0),
        place=error(own, ahead, place, hand),
        led_back=led_back,
    )


def warn_of_few_rows(results: Results, cars: Mapping[int, int]) -> None:
    """Say so when rows are recorded less often than the followers compute: what happens between them is not seen."""
    if not cars:
        return
    follower = f"car{min(cars)}.follower"
    rows, period = results.instants(follower), results.periods[follower]
    every = float(np.diff(results.time[rows]).max()) if len(rows) > 1 else math.inf
    if every > 1.5 * period:
        seen = f"every {every:g} s" if len(rows) > 1 else "once"
        _LOG.warning("the metrics see followers %s only: record every %g s for ones that miss nothing", seen, period)


def error(own: Vector, leader: Vector, offset: Vector, hand: float) -> Vector:
    """z (n, 2) of poses x, y, yaw (n, 3) and offsets (n, 2) [m]; `hand` is the distance a."""
    point = own[:, :2] + hand * _direction(own[:, 2])
    r = offset + np.array([hand, 0.0])
    return _turned(point - leader[:, :2] - _turned(r, leader[:, 2]), -own[:, 2])


def pose(results: Results, car: int, rows: np.ndarray) -> Vector:
    """x, y, yaw (n, 3) of the car's O1."""
    return np.stack([results[f"car{car}.plant.{name}"][rows] for name in ("position.x", "position.y", "yaw")], -1)


def offsets(results: Results, car: int) -> Vector:
    """The offsets (n, 2) [m] wanted at the follower's instants, moving smoothly during a change."""
    return np.stack([results.samples(f"car{car}.follower", f"offset.{axis}") for axis in "xy"], -1)


def commanded(results: Results, car: int) -> Vector:
    """The offsets (n, 2) [m] commanded at the follower's instants, which jump; an input that never changes is what was
    set of it."""
    rows = results.instants(f"car{car}.follower")

    def column(axis: str) -> Vector:
        name, variable = f"car{car}.follower.formation.{axis}", f"formation.{axis}"
        return results[name][rows] if name in results else np.full(len(rows), _told(results, car, variable, 0.0))

    return np.stack([column(axis) for axis in "xy"], -1)


def formation_changes(e: Errors, command: Vector, settled: float = SETTLED, until: float = math.inf) -> list[Change]:
    """The changes of formation that `command` (n, 2) makes up to `until` [s], each up to the next."""
    last = int(np.searchsorted(e.time, until))
    begins = jumps(command[:last])
    ends = [*begins[1:], last]
    far, size = np.linalg.norm(e.place, axis=1), np.linalg.norm(e.hand, axis=1)
    return [
        Change(float(e.time[i]), settling(e.time[i:j], far[i:j], settled), peak(size[i:j]))
        for i, j in zip(begins, ends, strict=False)  # no jump, no change
    ]


def settled_command(time: Vector, command: Vector, duration: float) -> np.ndarray:
    """Where (n,) the last change of `command` (n, 2) is `duration` [s] ago, or there was none."""
    begins = time[jumps(command)][:, None]
    return ~np.any((begins <= time) & (time < begins + duration), axis=0)


def settling(time: Vector, error: Vector, threshold: float) -> float:
    """Time [s] from the first row until the error stays below the threshold; NaN if it is above it at the end."""
    above = np.flatnonzero(np.abs(error) >= threshold)
    if not len(above):
        return 0.0
    return float(time[above[-1] + 1] - time[0]) if above[-1] + 1 < len(time) else math.nan


def efforts(results: Results, car: int) -> tuple[Vector, Vector]:
    """The acceleration commanded and the lateral acceleration v omega of the car (n,) [m/s2], at its instants."""
    rows = results.instants(f"car{car}.follower")
    lateral = _speed(results, car, rows) * results[f"car{car}.plant.angular_rate.z"][rows]
    return results.samples(f"car{car}.follower", "command.acceleration"), lateral


def _told(results: Results, car: int, variable: str, start: float) -> float:
    """The value of a parameter of the follower, `start` unless it was set."""
    return float(results.parameters.get(f"car{car}.follower", {}).get(variable, start))


def _speed(results: Results, car: int, rows: np.ndarray) -> Vector:
    return np.asarray(results[f"car{car}.plant.velocity.x"][rows])


def _direction(yaw: Vector) -> Vector:
    return np.stack((np.cos(yaw), np.sin(yaw)), -1)


def _turned(vectors: Vector, angle: Vector) -> Vector:
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack((c * x - s * y, s * x + c * y), -1)


def _worst(values: list[float], *, unknown: bool = False) -> float:
    """The largest; with `unknown` NaN as soon as one is NaN, else NaN only if there is no other."""
    known = [value for value in values if not math.isnan(value)]
    return math.nan if not known or (unknown and len(known) < len(values)) else max(known)
