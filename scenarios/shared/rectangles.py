"""Distances of rectangles in the plane."""

from __future__ import annotations

import numpy as np

from cosim.model.signals import Vector


def footprint(x: Vector, y: Vector, yaw: Vector, ahead: float, behind: float, width: float) -> Vector:
    """Corners (n, 4, 2) [m] of rectangles that reach `ahead` and `behind` of the points x, y (n,)."""
    corners = np.array([[ahead, 0.5 * width], [-behind, 0.5 * width], [-behind, -0.5 * width], [ahead, -0.5 * width]])
    c, s = np.cos(yaw), np.sin(yaw)
    rotation = np.stack((np.stack((c, -s), -1), np.stack((s, c), -1)), -2)
    return np.asarray(corners @ rotation.transpose(0, 2, 1) + np.stack((x, y), -1)[:, None, :])


def separation(moving: Vector, fixed: Vector) -> Vector:
    """Distances (n,) [m] of convex quadrilaterals `moving` (n, 4, 2) from `fixed` (4, 2); 0 where they overlap.

    Two that do not overlap are nearest at a corner of one of them; overlap is found by the separating axes.
    """
    still = np.broadcast_to(fixed, moving.shape)
    apart = np.minimum(_corners_to_edges(moving, still), _corners_to_edges(still, moving))
    away = np.logical_or(_separated(moving, still), _separated(still, moving))
    return np.where(away, apart, 0.0)


def _corners_to_edges(points: Vector, polygon: Vector) -> Vector:
    """Least distance (n,) of the corners of one (n, 4, 2) from the edges of the other."""
    begin = polygon[:, None, :, :]
    edge = np.roll(polygon, -1, axis=1)[:, None, :, :] - begin
    away = points[:, :, None, :] - begin
    part = np.clip(np.sum(away * edge, -1) / np.sum(edge**2, -1), 0, 1)
    return np.asarray(np.linalg.norm(away - part[..., None] * edge, axis=-1).min(axis=(1, 2)))


def _separated(polygon: Vector, other: Vector) -> Vector:
    """Whether (n,) the normal of an edge of the first separates it from the other."""
    edge = np.roll(polygon, -1, axis=1) - polygon
    normal = np.stack((-edge[..., 1], edge[..., 0]), -1)
    own, its = (np.einsum("nei,nci->nec", normal, corners) for corners in (polygon, other))
    return np.asarray(((own.max(-1) < its.min(-1)) | (its.max(-1) < own.min(-1))).any(axis=-1))
