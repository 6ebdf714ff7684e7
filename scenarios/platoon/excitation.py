"""How the head of a platoon drives on a straight: it brakes and accelerates, or excites all frequencies that matter.

The excitation is an odd multi-sine on its speed:

    v(t) = v_0 + fade(t) sum_k A/(2 pi f_k) sin(2 pi f_k t + phi_k),   phi_k = -pi k (k - 1)/n      (Schroeder)

All lines have the same amplitude A of acceleration, and those phases keep the largest acceleration small. The lines are
odd multiples of 1/`PERIOD`: what appears at even ones is noise or distortion, which `string_stability` compares with.
"""

from __future__ import annotations

import math

import numpy as np

from cosim.model.signals import Vector

PERIOD = 50.0
"""[s]; the slowest line is 0.02 Hz."""
LINES = (1, 3, 5, 7, 9, 11, 13, 17, 21, 25)
"""Excited multiples of 1/PERIOD: 0.02 to 0.5 Hz, more densely where a follower amplifies."""
_RISE = 5.0  # s
_FLANK = 0.5  # s


def multisine(t: Vector, acceleration: float) -> tuple[Vector, Vector]:
    """What is added to the speed (n,) [m/s] and its rate (n,) [m/s2] at times t >= 0 [s].

    `acceleration` [m/s2] is the root mean square of the rate once the signal is fully there, after 5 s.
    """
    omega = 2.0 * np.pi * np.asarray(LINES) / PERIOD
    k = np.arange(1, len(LINES) + 1)
    angle = np.multiply.outer(t, omega) - np.pi * k * (k - 1) / len(LINES)
    amplitude = acceleration * math.sqrt(2.0 / len(LINES))
    speed, rate = (amplitude * np.sin(angle) / omega).sum(-1), (amplitude * np.cos(angle)).sum(-1)
    xi = np.clip(t / _RISE, 0.0, 1.0)
    fade, fade_rate = xi**3 * (10 - 15 * xi + 6 * xi**2), 30 * xi**2 * (1 - xi) ** 2 / _RISE
    return fade * speed, fade * rate + fade_rate * speed


def braking(t: Vector) -> tuple[Vector, Vector]:
    """What is added to the speed (n,) [m/s] and its rate (n,) [m/s2]: at 0 s 5 m/s2 for some 3 s, down by 15 m/s, and
    from 7 s on 2.5 m/s2 for twice as long."""
    deceleration, acceleration = ((-5.0, 0.0, 3.5), (2.5, 7.0, 13.5))
    parts = [_pulse(t, *pulse) for pulse in (deceleration, acceleration)]
    return parts[0][0] + parts[1][0], parts[0][1] + parts[1][1]


def _pulse(t: Vector, height: float, begin: float, end: float) -> tuple[Vector, Vector]:
    """Integral and value of a pulse from begin to end with smooth flanks of `_FLANK`."""
    up, down = (np.clip((t - start) / _FLANK, 0.0, None) for start in (begin, end - _FLANK))
    values = [_step(xi)[0] for xi in (up, down)]
    areas = [_step(xi)[1] * _FLANK for xi in (up, down)]
    return height * (areas[0] - areas[1]), height * (values[0] - values[1])


def _step(xi: Vector) -> tuple[Vector, Vector]:
    """3 xi^2 - 2 xi^3 up to xi = 1, then 1; and its integral from 0."""
    part = np.minimum(xi, 1.0)
    return part**2 * (3 - 2 * part), part**3 * (1 - 0.5 * part) + (xi - part)


def straight(t: Vector, speed: Vector, rate: Vector) -> Vector:
    """Rows (n, 7) for ReferenceTrajectory: time, x, y, course, speed, acceleration, curvature on a straight."""
    steps = np.diff(t)
    way = 0.5 * steps * (speed[1:] + speed[:-1]) + steps**2 / 12.0 * (rate[:-1] - rate[1:])
    x = np.concatenate(([0.0], np.cumsum(way)))
    zero = np.zeros_like(t)
    return np.column_stack((t, x, zero, zero, speed, rate, zero))
