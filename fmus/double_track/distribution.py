"""Force distribution: four wheel forces U for a wanted y* = (F_x, F_y, M_z), the least-squares QP of the middle level.

    minimise  1/2 |W^(1/2) (G U + c - y*)|^2 + 1/2 epsilon |U|^2 + 1/2 rho |U - U_prev|^2   subject to  low <= U <= high

Forces are along the wheels, drive > 0, in the order fl, fr, rl, rr. The QP itself is in kN and kN m, so that its
numbers are of order one. Every function works on CasADi symbols and on numbers; numbers of the car may be symbols.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import casadi as ca

from fmus.cars.double_track import DoubleTrackCar
from fmus.clip import clip
from fmus.double_track.model import motion

N = 1e3
"""Newtons per unit of force in the QP."""
PATTERN_P = ca.Sparsity.upper(4)
PATTERN_A = ca.Sparsity.diag(4)
_LEAST_SPEED = 1.0
"""Speed [m/s] below which the power limit grows no further."""


@dataclass(frozen=True, slots=True)
class Weights:
    """W = diag(force_x, force_y, moment), `moment` per m2; epsilon and rho weigh U and its change; all for kN, kN m.

    Numbers or symbols. epsilon > 0 makes the problem strictly convex: three forces do not determine four.
    """

    force_x: Any
    force_y: Any
    moment: Any
    epsilon: Any
    rho: Any


@dataclass(frozen=True, slots=True)
class Limits:
    """What a wheel can do: motor force [N] and power [W], rate of its force [N/s], friction; numbers or symbols."""

    force: Any
    power: Any
    rate: Any
    friction: Any


class Named(Protocol):
    """Parameters of MpcAllocator by name, numbers or symbols."""

    def __getitem__(self, name: str, /) -> Any: ...


def weights_of(p: Named) -> Weights:
    """The weights among the parameters."""
    names = ("force_x", "force_y", "moment_z", "regularisation", "change")
    return Weights(*(p[f"distribution.{name}"] for name in names))


def limits_of(p: Named) -> Limits:
    """The limits among the parameters."""
    return Limits(*(p[f"limit.{name}"] for name in ("force", "power", "force_rate", "friction")))


def effectiveness(car: DoubleTrackCar, delta: Any) -> Any:
    """G (3 x 4): y = G U + c; delta [rad] turns both front wheels."""
    columns = []
    for (X, Y), angle in zip(car.wheel_positions, (delta, delta, 0.0, 0.0), strict=True):
        c, s = ca.cos(angle), ca.sin(angle)
        columns.append(ca.vertcat(c, s, X * s - Y * c))
    return ca.horzcat(*columns)


def without_drive(car: DoubleTrackCar, x: Any, a: Any) -> tuple[Any, Any, Any]:
    """c (3) [N, N, N.m]: the y of tyres, rolling resistance and air at U = 0; wheel loads and lateral forces (4) [N].

    x (7) is the state of the double-track car, a (2) [m/s2] the accelerations behind its wheel loads.
    """
    p = car.planar
    found = motion(car, x, ca.SX.zeros(5), a)
    return ca.vertcat(p.m * found.acceleration, p.I_zz * found.x_dot[5]), found.F_z, found.F_t


def bounds(
    limits: Limits, F_z: Any, F_t: Any, v: Any, *, available: Any, previous: Any = None, period: Any = None
) -> tuple[Any, Any]:
    """Lowest and highest force (4, 4) [N] of each wheel, never crossed.

    Motor force and power (speed v [m/s]) times `available` (4), 1 for a sound motor and 0 for a lost one; the friction
    left beside the lateral force F_t under the load F_z; the rate from `previous` (4) [N] over `period` [s] if given.
    Where what the rate reaches is outside the rest, the nearest of the rest is taken: friction wins.
    """
    motor = available * ca.fmin(limits.force, limits.power / ca.fmax(v, _LEAST_SPEED))
    grip = ca.sqrt(ca.fmax((limits.friction * F_z) ** 2 - F_t**2, 0))
    low, high = -ca.fmin(motor, grip), ca.fmin(motor, grip)
    if previous is None:
        return low, high
    step = limits.rate * period
    return clip(previous - step, low, high), clip(previous + step, low, high)


def problem(
    G: Any, c: Any, y_star: Any, *, previous: Any, low: Any, high: Any, weights: Weights
) -> tuple[Any, Any, Any, Any, Any]:
    """(P_nz (10), q (4), A_nz (4), l (4), u (4)) of the QP 1/2 U'PU + q'U, l <= A U <= u in kN; A is the identity.

    P_nz are the nonzeros of the upper triangle `PATTERN_P` by columns, A_nz those of `PATTERN_A`.
    """
    w = weights
    W = ca.diag(ca.vertcat(w.force_x, w.force_y, w.moment))
    P = G.T @ W @ G + (w.epsilon + w.rho) * ca.DM.eye(4)
    q = -(G.T @ W @ (y_star - c) + w.rho * previous) / N
    P_nz = ca.vertcat(*(P[i, j] for j in range(4) for i in range(j + 1)))
    return P_nz, q, ca.DM.ones(4), low / N, high / N


def residual(G: Any, c: Any, y_star: Any, U: Any) -> Any:
    """G U + c - y* (3) [N, N, N.m]: what is too much."""
    return G @ U + c - y_star
