"""Errors of a follower: how far it is from where it is wanted; on true states, at the instants at which it computed.

The error is that of its hand point, which is what is controlled, in its own axes, actual minus desired:

    z = R(psi_i)^T (h_i - h_L - R(psi_f) offset),   h = O1 + a (cos psi, sin psi)

h_L is the leader's true hand now, not what the radio last said; the offset is the one wanted now, as the follower gives
it; psi_f is the yaw angle of its axes (`axes`), the leader's own or that of the rod that trails from its true hand. The
error of O1 is that to a ahead of it in these axes, which in a bend is not zero for a follower without error. A follower
far from its place may lead itself back along an offset of its own; how far it then is from the place commanded is the
error of place.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from scenarios.formation.axes import axes, hand_points
from scenarios.formation.course import course, jumps, wanted


@dataclass(frozen=True, slots=True)
class FollowerErrors:
    """Errors z (n, 2) [m] of one follower at its instants.

    `hand` is that of the hand point, `position` that of O1, and `place` that of the hand point to the place commanded,
    which a change of formation moves at once. `jumps` are the rows at which that place becomes another, and `changing`
    says where (n,) a change is under way; `led_back` says where (n,) the follower led itself back. `seen` (n, 2)
    [m] is where O1 is in the axes of its place.
    """

    time: Vector
    hand: Vector
    position: Vector
    place: Vector
    seen: Vector
    jumps: np.ndarray
    changing: np.ndarray
    led_back: np.ndarray


def errors_of_followers(results: Results, leaders: Mapping[int, int]) -> dict[int, FollowerErrors]:
    """The errors of all followers by number; `leaders` says who follows whom: {2: 1, 3: 2} is a chain of three cars."""
    return {car: follower_errors(results, car, leader) for car, leader in leaders.items()}


def follower_errors(results: Results, car: int, leader: int) -> FollowerErrors:
    """The errors of `car`, which follows `leader`; hand, headway and duration are those its follower was told."""
    follower, rows = f"car{car}.follower", results.instants(f"car{car}.follower")
    hand, headway = results.number(follower, "hand.distance"), results.number(follower, "headway")
    duration = results.number(follower, "formation.duration")
    own, ahead = pose(results, car, rows), pose(results, leader, rows)
    time, speed, command = results.time[rows], results[f"car{car}.plant.velocity.x"][rows], _commanded(results, car)
    offset, led_back = wanted(time, _offsets(results, car), course(time, command, duration), speed, headway)
    place = command - headway * np.stack((speed, 0 * speed), -1)
    yaw = axes(results, car, ahead, offset)
    away = hand_points(own, hand) - hand_points(ahead, hand)
    seen = _turned(own[:, :2] - hand_points(ahead, hand), -yaw) + np.array([hand, 0.0])
    return FollowerErrors(
        time=time,
        hand=_turned(away - _turned(offset, yaw), -own[:, 2]),
        position=_turned(seen - offset, yaw - own[:, 2]),
        place=_turned(away - _turned(place, yaw), -own[:, 2]),
        seen=seen,
        jumps=jumps(command),
        changing=_within(time, time[jumps(command)], duration),
        led_back=led_back,
    )


def pose(results: Results, car: int, rows: np.ndarray) -> Vector:
    """x, y, yaw (n, 3) of the car's O1."""
    return np.stack([results[f"car{car}.plant.{name}"][rows] for name in ("position.x", "position.y", "yaw")], -1)


def _offsets(results: Results, car: int) -> Vector:
    """The offsets (n, 2) [m] wanted at the follower's instants, moving smoothly during a change."""
    return np.stack([results.samples(f"car{car}.follower", f"offset.{axis}") for axis in "xy"], -1)


def _commanded(results: Results, car: int) -> Vector:
    """The offsets (n, 2) [m] commanded at the follower's instants, which jump.

    An input that never changes is not recorded: it has the value it started with.
    """
    follower = f"car{car}.follower"
    rows = results.instants(follower)

    def column(variable: str) -> Vector:
        name = f"{follower}.{variable}"
        return results[name][rows] if name in results else np.full(len(rows), results.number(follower, variable))

    return np.stack([column(f"formation.{axis}") for axis in "xy"], -1)


def _within(time: Vector, begins: Vector, duration: float) -> np.ndarray:
    """Where (n,) one of the times `begins` [s] is less than `duration` [s] ago."""
    return np.any((begins[:, None] <= time) & (time < begins[:, None] + duration), axis=0)


def _turned(vectors: Vector, angle: Vector) -> Vector:
    c, s = np.cos(angle), np.sin(angle)
    x, y = vectors[:, 0], vectors[:, 1]
    return np.stack((c * x - s * y, s * x + c * y), -1)
