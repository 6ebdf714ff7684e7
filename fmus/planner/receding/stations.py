"""Where the gates of a road stand: `road.spacing` apart, and closer where the car is slow or an edge bends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..gates import Gates, gradual
from . import limits
from .centre_line import Spline, even, measured
from .layout import SUBSTEPS
from .speed import profile

Array = NDArray[np.float64]
_STABLE = 2.78
"""Largest product of damping and step for which the Runge-Kutta method of order four is stable."""
_NEAREST = 1.0
"""Smallest distance [m]."""
_BOW, _ROUGH = 0.1, 4.0
"""Bow [m] of an edge between two gates that is aimed at, and the spacing [m] down to which."""
_PATH, _SHARPEST, _MOST_INSET = 0.6, 0.7, 0.3
"""The path bends this part as much as the line; largest part of the radius that the road has inside a bend; largest
inset [m]."""
_STEP = 1.0
"""Distance [m] of the points at which the spacing is looked at."""


def stations(curve: Spline, room: Array | None, p: Mapping[str, Any], closed: bool) -> tuple[Array, Array]:
    """Parameters of the gates on the curve, and their distances [m] along it.

    `room` (n, 2) [m] at the points of the curve, to the left and to the right; without it edges are not looked at.
    """
    dense, length = measured(curve, p["road.spacing"])
    s = np.linspace(0.0, length[-1], max(round(length[-1] / _STEP), 4) + 1)
    places = np.interp(s, length, dense)
    bends = _bends(curve, places, s, p["road.spacing"], closed)
    h = _stable(p, s, bends, closed)
    if room is not None:
        left, right = (np.interp(places, curve.s, room[:, j]) for j in (0, 1))
        h = np.minimum(h, np.maximum(np.sqrt(_BOW / np.maximum(_bulge(bends, left, right), 1e-9)), _ROUGH))
    h = gradual(h, s, closed)
    if (h == p["road.spacing"]).all():
        return even(curve, p["road.spacing"])
    passed = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(s) * (1 / h[1:] + 1 / h[:-1]))])
    count = max(2, round(passed[-1]))
    at = np.interp(np.linspace(0.0, passed[-1], count + 1), passed, s)
    return np.interp(at, length, dense), at


def _bends(curve: Spline, dense: Array, s: Array, spacing: float, closed: bool) -> Array:
    """(n,) [1/m] curvature as gates `spacing` [m] apart see it: the turn over this distance."""
    slope = curve.slope(dense)
    heading = np.unwrap(np.arctan2(slope[:, 1], slope[:, 0]))
    turn, whole = heading[-1] - heading[0], s[-1]
    if closed:
        s = np.concatenate([s[:-1] - whole, s, s[1:] + whole])
        heading = np.concatenate([heading[:-1] - turn, heading, heading[1:] + turn])
    middle = np.linspace(0.0, whole, len(dense))
    ends = (np.interp(middle + part * spacing, s, heading) for part in (0.5, -0.5))
    return np.asarray(next(ends) - next(ends)) / spacing


def _stable(p: Mapping[str, Any], s: Array, bends: Array, closed: bool) -> Array:
    """(n,) [m]: as far as the integration is stable.

    The yaw motion dies out with (l_F^2 C_F + l_R^2 C_R)/(I_zz v) [1/s]; a substep takes spacing/(SUBSTEPS v).
    """
    arm = [p[f"design.geometry.{axle}_axle"] for axle in ("front", "rear")]
    stiffness = [
        np.prod([p[f"design.tyre.{axle}.{name}"] for name in ("stiffness_factor", "shape_factor", "peak")])
        for axle in ("front", "rear")
    ]
    damping = sum(a**2 * c for a, c in zip(arm, stiffness, strict=True)) / p["design.body.inertia.z"]
    end = p["limit.speed"] if closed else p["end.speed"]
    v = np.minimum(profile(bends, np.diff(s), limits.lateral(p), limits.braking(p), end), p["limit.speed"])
    v[0] = min(v[0], p["initial.speed"])
    return np.clip(v**2 * _STABLE * SUBSTEPS / damping, min(_NEAREST, p["road.spacing"]), p["road.spacing"])


def _bulge(bends: Array, left: Array, right: Array) -> Array:
    """(n,) [1/m]: how much more than the path the inner edge of a bend bends, over 8: times l^2 it is its bow on l."""
    inner = np.where(bends > 0, left, right)
    edge = np.abs(bends) / (1 - np.clip(np.abs(bends) * inner, 0.0, _SHARPEST))
    return np.asarray(edge - _PATH * np.abs(bends)) / 8


def inset(gates: Gates, curvature: Array, at: Array) -> Gates:
    """The gates less the bow of the inner edge between them, which the path would otherwise cut."""
    length = np.diff(at)
    longest = np.maximum(np.append(length, length[-1]), np.append(length[0], length))
    bow = _bulge(curvature, gates.high, -gates.low) * longest**2
    bow = np.maximum(bow, np.maximum(np.append(bow[1:], bow[-1]), np.append(bow[0], bow[:-1])))
    bow = np.minimum(bow, np.minimum(_MOST_INSET, 0.4 * (gates.high - gates.low)))
    low, high = (np.where(side * curvature > 0, bow, 0.0) for side in (-1, 1))
    return Gates(gates.frames, gates.low + low, gates.high - high, gates.closed)
