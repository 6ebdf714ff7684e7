"""The constraints of a whole formation at once: what one law for all vehicles would do.

A follower of the product solves for itself, with the rows of `fmus.controllers.constraint_follower.law`.
"""

from __future__ import annotations

from collections.abc import Iterable

import casadi as ca

from fmus.controllers.constraint_follower.constraints import COORDINATES, offset, rows


def formation(edges: Iterable[tuple[int, int]], vehicles: int) -> ca.Function:
    """Joint rows of the offset constraints of a formation: (q, q', r, r', r'', none) -> (C, W, C', gamma).

    edges: (follower, leader) pairs; q (3 vehicles) stacks the vehicles, r (2 edges) the offsets, C has 2 rows per edge.
    """
    pairs = tuple(edges)
    q, r = ca.SX.sym("q", COORDINATES * vehicles), ca.SX.sym("r", 2 * len(pairs))
    parts = ca.vertsplit(q, COORDINATES)
    C = [offset(parts[i], parts[j], r[2 * k : 2 * k + 2]) for k, (i, j) in enumerate(pairs)]
    return rows(ca.vertcat(*C), q, r, ca.SX.sym("none", 0))


def isolated(W: ca.SX, edges: Iterable[tuple[int, int]]) -> ca.SX:
    """W of `formation` without the columns of the leaders: to its followers a leader has infinite mass.

    The followers' law has the leader among its driven coordinates, which is the same.
    What is left are blocks of 2 x 3, one per follower, which each solves alone.
    """
    kept = ca.SX.zeros(*W.shape)
    for k, (i, _) in enumerate(edges):
        block = slice(2 * k, 2 * k + 2), slice(COORDINATES * i, COORDINATES * (i + 1))
        kept[block] = W[block]
    return kept
