"""What a plan is worth: its path on a finer grid, and a replay by an independent integrator."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

from fmus.planner.gates import Array
from fmus.planner.program import Nodes
from fmus.planner.shooting import interval
from fmus.planner.vehicle import Vehicle

FINER = 10


def fine(vehicle: Vehicle, nodes: Nodes, substeps: int, finer: int = FINER) -> tuple[Array, Array, Array]:
    """(times (n,), states (7, n), inputs (n_u, n)) at `finer` points per interval and at the end.

    Every interval starts from its own node and is integrated with `substeps` substeps between two points.
    """
    m = len(nodes.T)
    parts, x = [nodes.x[:, :m]], nodes.x[:, :m]
    step = interval(vehicle.f, max(1, substeps)).map(m)
    for _ in range(finer - 1):
        x = step(x, nodes.u, nodes.T[None, :] / finer).full()
        parts.append(x)
    states = np.stack(parts, axis=2).reshape(len(x), -1)
    times = nodes.times[:-1, None] + nodes.T[:, None] * np.arange(finer) / finer
    inputs = np.repeat(nodes.u, finer, axis=1)
    return (
        np.append(times.ravel(), nodes.times[-1]),
        np.column_stack([states, nodes.x[:, -1]]),
        np.column_stack([inputs, nodes.u[:, -1]]),
    )


def replay(vehicle: Vehicle, nodes: Nodes, *, restart: bool = False) -> float:
    """Largest distance [m] from the nodes when the inputs are replayed by DOP853 of SciPy.

    From the first state on; with `restart` every interval from its own node, which leaves out how a car near its
    limits multiplies small errors over a long drive without feedback.
    """
    if restart:
        return _away(_each(vehicle, nodes), nodes.x[:, 1:])
    x, worst = nodes.x[:, 0], 0.0
    for k, T in enumerate(nodes.T):
        arguments = vehicle, nodes.u[:, k]
        x = solve_ivp(motion, (0, T), x, method="DOP853", rtol=1e-9, atol=1e-9, args=arguments).y[:, -1]
        worst = max(worst, _away(x, nodes.x[:, k + 1]))
    return worst


def _each(vehicle: Vehicle, nodes: Nodes) -> Array:
    """(7, m) where every interval ends, begun at its own node: all at once, each in parts of its own length."""
    first, m = nodes.x[:, :-1], len(nodes.T)
    f = vehicle.f.map(m)

    def rate(_: float, x: Array) -> Array:
        return (f(x.reshape(first.shape), nodes.u).full() * nodes.T).ravel()

    found = solve_ivp(rate, (0.0, 1.0), first.ravel(), method="DOP853", rtol=1e-10, atol=1e-10).y[:, -1]
    return np.asarray(found.reshape(first.shape))


def _away(x: Array, nodes: Array) -> float:
    return float(np.hypot(*(x[:2] - nodes[:2])).max())


def motion(_: float, x: Array, vehicle: Vehicle, u: Array) -> Array:
    """x' in the form that SciPy's integrators want."""
    return vehicle.f(x, u).full().ravel()
