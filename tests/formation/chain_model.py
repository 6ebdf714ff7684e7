"""A chain of followers on a straight, written down apart from the components: points with a linear law.

    v_k = v_ff - K z_k + n_k,   n_k' = -K_i z_k,   z_k = p_k - p_{k-1} + d + h p_k'
    p_k' = v_k, or with a lag of the speed  tau p_k'' = v_k - p_k'

`simulate` solves it by the classical Runge-Kutta method; `transfer` gives p_k / p_{k-1} in closed form.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fmukit.integration import rk4

Motion = Callable[[float], tuple[float, float]]
"""Position and speed of the head, less d and the mean speed, at a time."""


@dataclass(frozen=True)
class Law:
    gain: float = 2.0
    integral: float = 2.0
    headway: float = 0.0
    lag: float = 0.0
    """Of the speed [s]."""
    delay: float = 0.0
    """Of what is measured of the leader [s]; in `transfer` only."""
    feedforward: bool = False
    """The head's speed is known to all."""


def transfer(law: Law, omega: np.ndarray) -> np.ndarray:
    """p_k / p_{k-1} at j omega; without lag and delay (K s + K_i) / ((1 + K h) s^2 + (K + K_i h) s + K_i)."""
    s = 1j * omega
    loop = (law.gain * s + law.integral) / s**2 / (1 + law.lag * s)
    return loop * np.exp(-law.delay * s) / (1 + loop * (1 + law.headway * s))


def largest(law: Law) -> float:
    """sup |transfer| over frequencies."""
    return float(np.abs(transfer(law, np.logspace(-3, 2, 20001))).max())


@dataclass(frozen=True)
class Drive:
    """Head first: positions and speeds (n, cars), errors z (n, followers) at `time` (n,)."""

    time: np.ndarray
    positions: np.ndarray
    speeds: np.ndarray
    errors: np.ndarray

    @staticmethod
    def of(time: np.ndarray, rows: list[tuple[np.ndarray, ...]]) -> Drive:
        """From (positions, speeds, errors) at every time."""
        return Drive(time, *(np.array(column) for column in zip(*rows, strict=True)))


def simulate(law: Law, head: Motion, followers: int, stop: float, star: bool = False, step: float = 0.01) -> Drive:
    """Everybody starts in its place, the head as `head` says."""
    start = head(0.0)
    state = np.array([np.full(followers, start[0]), np.zeros(followers), np.full(followers, start[1])])
    time = step * np.arange(round(stop / step))
    rows = []
    for t in time:
        rows.append(_row(law, head(t), state, star))
        state = rk4(lambda x, part, t=t: _rate(law, head(t + part * step), x, star), state, step)
    return Drive.of(time, rows)


def _row(law: Law, head: tuple[float, float], state: np.ndarray, star: bool) -> tuple[np.ndarray, ...]:
    v, z = _speeds(law, head, state, star)
    return np.concatenate(([head[0]], state[0])), np.concatenate(([head[1]], v)), z


def _speeds(law: Law, head: tuple[float, float], state: np.ndarray, star: bool) -> tuple[np.ndarray, np.ndarray]:
    """v and z; with headway and without lag v appears on both sides of the law and is solved for."""
    p, n, v = state
    ahead = np.full_like(p, head[0]) if star else np.concatenate(([head[0]], p[:-1]))
    known = head[1] * law.feedforward + n - law.gain * (p - ahead)
    v = v if law.lag else known / (1 + law.gain * law.headway)
    return v, p - ahead + law.headway * v


def _rate(law: Law, head: tuple[float, float], state: np.ndarray, star: bool) -> np.ndarray:
    v, z = _speeds(law, head, state, star)
    command = head[1] * law.feedforward + state[1] - law.gain * z
    return np.array([v, -law.integral * z, (command - v) / law.lag if law.lag else 0 * v])
