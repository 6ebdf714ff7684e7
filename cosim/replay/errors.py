"""How far what came out of a replay is from what was logged."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize_scalar

from cosim.model.signals import Vector
from cosim.replay.columns import Measured


@dataclass(frozen=True, slots=True)
class Error:
    """Of one signal in its unit: root mean square and largest error, both also relative to the range of the log.

    With the output shifted by `lag` [s], positive where it is late, the root mean square is least: `rms_at_lag`.
    """

    signal: str
    unit: str
    rms: float
    largest: float
    reach: float
    lag: float
    rms_at_lag: float


def error(signal: str, unit: str, time: Vector, values: Vector, log: Measured, longest_lag: float) -> Error:
    """The error of an output `values` at `time` [s]; it is taken at the times of the log that both have."""
    inside = (log.times >= time[0] + longest_lag) & (log.times <= time[-1] - longest_lag)
    if not inside.any():
        inside = (log.times >= time[0]) & (log.times <= time[-1])
    at, logged = log.times[inside], log.values[inside]

    def rms(lag: float) -> float:
        return float(np.sqrt(np.mean((np.interp(at + lag, time, values) - logged) ** 2)))

    apart = np.interp(at, time, values) - logged
    lags = np.linspace(-longest_lag, longest_lag, 201)
    best = lags[int(np.argmin([rms(lag) for lag in lags]))]
    width = lags[1] - lags[0]
    found = minimize_scalar(rms, bounds=(best - width, best + width), method="bounded", options={"xatol": 1e-5})
    reach = float(np.ptp(logged)) or 1.0
    return Error(signal, unit, rms(0.0), float(np.abs(apart).max()), reach, float(found.x), float(found.fun))
