"""A rod towed by one of its ends: the other end moves along the rod, as a differential equation of its own."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

Way = Callable[[float], complex]
"""Where the towed end is at a time [m], in the complex plane."""
_SHORT = 1e-4


def rate(way: Callable[[float], complex], t: float) -> complex:
    """Its velocity by central differences."""
    return (way(t + _SHORT) - way(t - _SHORT)) / (2 * _SHORT)


def angles(way: Way, length: Callable[[float], float], first: float, time: np.ndarray) -> np.ndarray:
    """Angle (n,) [rad] of a rod of length l(t) [m] at each time: psi' = Im(h' exp(-j psi))/l."""

    def turning(t: float, psi: np.ndarray) -> np.ndarray:
        return np.imag(rate(way, t) * np.exp(-1j * psi)) / length(t)

    found = solve_ivp(turning, (time[0], time[-1]), [first], t_eval=time, rtol=1e-10, atol=1e-12, max_step=0.1)
    return np.asarray(found.y[0])
