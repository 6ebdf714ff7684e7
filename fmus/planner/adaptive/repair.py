"""Between its nodes a plan may leave the road by some centimetres: gates that are a little narrower bring it back."""

from __future__ import annotations

import numpy as np

from fmus.planner import check
from fmus.planner.adaptive.mesh import Mesh
from fmus.planner.adaptive.search import Found
from fmus.planner.gates import Array
from fmus.planner.path_road import PathRoad
from fmus.planner.vehicle import Vehicle

ROUNDS = 2
"""Repairs at most."""
ALLOWED, _MORE = 0.008, 0.004
"""What is let pass, and by how much more than its excess a gate is narrowed [m]."""


def excess(vehicle: Vehicle, road: PathRoad, found: Found) -> Array:
    """(m, 2) [m] by which each interval leaves the road on the left and on the right, on a ten times finer grid."""
    made, nodes = found.mesh, found.solution.nodes
    points = check.fine(vehicle, nodes, made.substeps)[1][:2].T
    at = np.interp(np.arange(len(points)) / check.FINER, np.arange(len(made.at)), made.at)
    outside = road.outside(points, np.interp(at, made.line.s, made.line.beneath))
    inner = outside[:-1].reshape(made.intervals, check.FINER, 2).max(axis=1)
    ends = outside[check.FINER :: check.FINER]
    return np.maximum(np.maximum(inner, ends), 0.0)


def narrowed(made: Mesh, excess: Array) -> Mesh:
    """The mesh with the gates beside intervals that leave the road moved inwards."""
    more = np.where(excess > ALLOWED, excess + _MORE, 0.0)
    before, after = (more[-1:], more[:1]) if made.line.closed else (more[:1], more[-1:])
    more = np.vstack([before, more, after])
    left, right = np.maximum(more[1:], more[:-1]).T
    return made.inset(right, left)
