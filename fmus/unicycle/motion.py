"""Speed, yaw rate and pose of a vehicle that moves where it points, a step ahead. Equations in README.md."""

from __future__ import annotations

from math import sqrt

import casadi as ca

_NONE = 1e-6  # s, a lag below it is none
_NODES = ((0.5 - sqrt(15) / 10, 5 / 18), (0.5, 8 / 18), (0.5 + sqrt(15) / 10, 5 / 18))
"""Gauss-Legendre quadrature on [0, 1] (place, weight), exact up to degree five."""


class FirstOrder:
    """w' = (w_c - w)/T + a with w_c and a held, from `start` on; T = 0: w = w_c.

    Exact for any time s > 0 after the start.
    """

    def __init__(self, start: ca.SX, command: ca.SX, lag: ca.SX, acceleration: ca.SX) -> None:
        self._T = ca.if_else(lag < _NONE, 0, lag)
        self._end = command + self._T * acceleration
        self._off = start - self._end

    def value(self, s: ca.SX) -> ca.SX:
        """w(s)."""
        return self._end + self._off * self._decay(s)

    def integral(self, s: ca.SX) -> ca.SX:
        """int w over [0, s]."""
        return self._end * s + self._off * self._T * (1 - self._decay(s))

    def _decay(self, s: ca.SX) -> ca.SX:
        return ca.if_else(self._T > 0, ca.exp(-s / ca.fmax(self._T, _NONE)), 0)


def rate(now: ca.SX, command: ca.SX, lag: ca.SX, acceleration: ca.SX) -> ca.SX:
    """w' = (w_c - w)/T + a; 0 without lag, where w is w_c, which is held."""
    return ca.if_else(lag < _NONE, 0, (command - now) / ca.fmax(lag, _NONE) + acceleration)


def displacement(speed: FirstOrder, yaw_rate: FirstOrder, yaw: ca.SX, h: ca.SX) -> ca.SX:
    """int v (cos psi, sin psi) over h [s] (2): quadrature of order six, the distance driven exact."""
    times = [place * h for place, _ in _NODES]
    speeds = [speed.value(s) for s in times]
    correction = speed.integral(h) / h - sum(weight * v for (_, weight), v in zip(_NODES, speeds, strict=True))
    total = ca.SX.zeros(2)
    for (_, weight), v, s in zip(_NODES, speeds, times, strict=True):
        psi = yaw + yaw_rate.integral(s)
        total += weight * (v + correction) * ca.vertcat(ca.cos(psi), ca.sin(psi))
    return h * total
