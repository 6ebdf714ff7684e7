"""The axes in which a follower's place is wanted, from true motions: the leader's, or those of the rod it trails."""

from __future__ import annotations

from functools import lru_cache

import casadi as ca
import numpy as np

from cosim.model.signals import Vector
from cosim.results.reading import Results
from fmus.controllers.formation.frame import towed


def axes(results: Results, car: int, leader: Vector, offset: Vector) -> Vector:
    """Yaw angles (n,) [rad] of the axes of `car`, from its leader's poses x, y, yaw (n, 3) and its offset (n, 2) [m].

    They are those of its follower's `frame.trailing`. The rod lies along the leader in the first row.
    """
    follower = f"car{car}.follower"
    if not results.number(follower, "frame.trailing") or len(leader) < 2:
        return leader[:, 2]
    a = results.number(follower, "hand.distance")
    return trailing(hand_points(leader, a), np.maximum(np.hypot(*offset.T), a), leader[0, 2])


def hand_points(poses: Vector, a: float) -> Vector:
    """The points (n, 2) [m] that are `a` [m] ahead of O1, of poses x, y, yaw (n, 3)."""
    return np.asarray(poses[:, :2] + a * np.stack((np.cos(poses[:, 2]), np.sin(poses[:, 2])), -1))


def trailing(hand: Vector, length: Vector, yaw: float) -> Vector:
    """Yaw angles (n,) [rad] of rods of these lengths (n,) [m] towed along the points `hand` (n, 2), from `yaw` on."""
    ways = np.diff(hand, axis=0)
    later = np.asarray(_rods(len(ways))(yaw, ways.T, length[1:])).ravel()
    return np.concatenate(([yaw], later))


@lru_cache(maxsize=4)
def _rods(steps: int) -> ca.Function:
    """(yaw, ways (2 x steps), lengths (1 x steps)) -> yaw after each step (1 x steps)."""
    yaw, way, length = ca.SX.sym("yaw"), ca.SX.sym("way", 2), ca.SX.sym("length")
    return ca.Function("rod", [yaw, way, length], [towed(yaw, way, length)]).mapaccum(steps)
