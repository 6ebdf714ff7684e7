"""Where a search on a mesh begins: along its line, turning steadily, or at the plan on another mesh of the line."""

from __future__ import annotations

import numpy as np

from fmus.planner.adaptive.mesh import Mesh
from fmus.planner.adaptive.search import Found
from fmus.planner.frames import into_frames, out_of_frames
from fmus.planner.gates import Array
from fmus.planner.program import Nodes
from fmus.planner.vehicle import Vehicle

_WHEELBASE = 2.6
"""[m]: the steering of the guess, not of the car."""


def along(vehicle: Vehicle, made: Mesh, v: Array) -> Nodes:
    """Nodes on the line for the speeds `v` (n,) [m/s] of its points."""
    line, at, gates = made.line, made.at, made.gates
    speed, kappa = np.interp(at, line.s, v), np.interp(at, line.s, line.curvature)
    x = np.zeros((len(vehicle.scale), len(at)))
    x[1] = np.clip(0.0, gates.low, gates.high)
    x[2], x[5] = np.clip(speed, vehicle.lower[2], vehicle.upper[2]), speed * kappa
    x[6] = np.clip(_WHEELBASE * kappa, vehicle.lower[6], vehicle.upper[6])
    T = 2 * np.diff(at) / (x[2, 1:] + x[2, :-1])
    u = np.repeat(vehicle.idle[:, None], len(T), axis=1)
    return Nodes(out_of_frames(x, gates.frames), u, T)


def moved(found: Found, made: Mesh) -> Nodes:
    """The nodes of a plan, linear between its gates, on another mesh of the same line; inputs are held."""
    nodes, at = found.solution.nodes, found.mesh.at
    x = into_frames(nodes.x, found.mesh.gates.frames)
    new = np.array([np.interp(made.at, at, row) for row in x])
    held = np.clip(np.searchsorted(at, made.at[:-1], side="right") - 1, 0, len(nodes.T) - 1)
    return Nodes(out_of_frames(new, made.gates.frames), nodes.u[:, held], np.diff(np.interp(made.at, at, nodes.times)))
