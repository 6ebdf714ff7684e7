"""The nonlinear program of a plan: what both grids have in common."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import casadi as ca
import numpy as np

from fmus.planner.frames import into_frames, out_of_frames
from fmus.planner.gates import Array, Gates
from fmus.planner.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class Ends:
    """First and last state (7,) in the frame of the first and last gate; NaN is free."""

    first: Array
    last: Array


def standing_ends(speed: float = 10.0) -> Ends:
    """Straight ahead at `speed` [m/s], lateral position free; at the end straight again, all else free."""
    free = np.nan
    return Ends(np.array([0, free, speed, 0, 0, 0, 0]), np.array([0, free, free, free, 0, free, free]))


@dataclass(frozen=True, slots=True)
class Nodes:
    """A plan at its m + 1 nodes: `x` (7, m+1) in the world, inputs `u` (n_u, m), interval lengths `T` (m,) [s]."""

    x: Array
    u: Array
    T: Array

    @property
    def times(self) -> Array:
        """(m+1,) [s]."""
        return np.concatenate([[0.0], np.cumsum(self.T)])


@dataclass(frozen=True, slots=True)
class Symbols:
    """All decision variables in one `column`, the scaled states, inputs and lengths in it, and physical values."""

    column: ca.MX
    X: ca.MX
    U: ca.MX
    T: ca.MX
    x: ca.MX
    u: ca.MX


@dataclass(frozen=True, slots=True)
class NonlinearProgram:
    """`nlp` in scaled variables with their bounds; `origin` (m+1, 3): frames the states are written in.

    `derivatives`: options `jac_g` and `hess_lag` of CasADi's solvers, which without them find their own.
    """

    nlp: dict[str, Any]
    lower: Array
    upper: Array
    g_lower: Array
    g_upper: Array
    parameters: Array
    origin: Array
    vehicle: Vehicle
    intervals: int
    derivatives: dict[str, ca.Function] = field(default_factory=dict)

    def pack(self, nodes: Nodes) -> Array:
        """Decision variables of a plan, within their bounds."""
        x, T = into_frames(nodes.x, self.origin), nodes.T[: self.intervals]
        parts = x / self.vehicle.scale[:, None], nodes.u / self.vehicle.input_scale[:, None], T
        return np.clip(np.concatenate([part.ravel("F") for part in parts]), self.lower, self.upper)

    def unpack(self, w: Array) -> Nodes:
        """The plan of the decision variables."""
        n, m = len(self.vehicle.scale), len(self.origin) - 1
        n_u = len(self.vehicle.input_scale)
        x = w[: n * (m + 1)].reshape((n, m + 1), order="F") * self.vehicle.scale[:, None]
        u = w[n * (m + 1) :][: n_u * m].reshape((n_u, m), order="F") * self.vehicle.input_scale[:, None]
        T = w[n * (m + 1) + n_u * m :]
        return Nodes(out_of_frames(x, self.origin), u, np.broadcast_to(T, (m,)).copy())


def decision(vehicle: Vehicle, m: int, lengths: int) -> Symbols:
    """Fresh variables for m intervals with `lengths` (1 or m) free interval lengths."""
    n, n_u = len(vehicle.scale), len(vehicle.input_scale)
    return decided(ca.MX.sym("w", n * (m + 1) + n_u * m + lengths), vehicle, m)


def decided(column: ca.MX, vehicle: Vehicle, m: int) -> Symbols:
    """The parts of a column of decision variables for m intervals."""
    n, n_u = len(vehicle.scale), len(vehicle.input_scale)
    X, U, T = ca.vertsplit(column, [0, n * (m + 1), n * (m + 1) + n_u * m, column.numel()])
    X, U = ca.reshape(X, n, m + 1), ca.reshape(U, n_u, m)
    x, u = ca.diag(ca.DM(vehicle.scale)) @ X, ca.diag(ca.DM(vehicle.input_scale)) @ U
    return Symbols(column, X, U, T.T, x, u)


def roughness(s: Symbols) -> ca.MX:
    """Sum of the squared changes of the scaled inputs."""
    return ca.sumsqr(s.U[:, 1:] - s.U[:, :-1])


def limits(vehicle: Vehicle, s: Symbols) -> ca.MX:
    """The vehicle's own inequalities at every interval (<= 0); empty if it has none."""
    if vehicle.limits is None:
        return ca.MX(0, 1)
    return ca.vec(vehicle.limits.map(s.U.shape[1])(s.x[:, :-1], s.u))


def state_bounds(vehicle: Vehicle, gates: Gates, ends: Ends) -> tuple[Array, Array]:
    """Bounds (7, m+1) of the states in the frames of the gates, but for the position."""
    count = len(gates.frames)
    low, high = (np.repeat(bound[:, None], count, axis=1) for bound in (vehicle.lower, vehicle.upper))
    for k, end in ((0, ends.first), (-1, ends.last)):
        fixed = ~np.isnan(end)
        low[fixed, k] = high[fixed, k] = end[fixed]
    return low, high


def scaled(vehicle: Vehicle, x: Array, u: Array, T: Array) -> Array:
    """A column in the order of the decision variables from states (7, m+1), one input for all intervals, and T."""
    inputs = np.tile(u / vehicle.input_scale, x.shape[1] - 1)
    return np.concatenate([(x / vehicle.scale[:, None]).ravel("F"), inputs, T])
