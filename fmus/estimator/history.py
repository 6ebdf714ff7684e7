"""The last samples, oldest first, and moving a belief from any time to any time over them."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout, block
from fmus.estimator.correction import LEVER
from fmus.estimator.navigation import BELIEF, PROCESS, READING, propagate_if

SAMPLES = 80
"""Rows kept: 0.4 s at 5 ms."""
ROW = Layout(reading=READING.size, lever=LEVER.size)
"""`reading` is the mean over the interval that ends with the sample, `lever` belongs to its end."""
_NOTHING = 1e-9  # s, shorter intervals are skipped


@block(symbol=ca.MX, belief=BELIEF.size, rows=(ROW.size, SAMPLES), start=1, end=1, T=1, process=PROCESS.size)
def transport(belief: ca.MX, rows: ca.MX, start: ca.MX, end: ca.MX, T: ca.MX, process: ca.MX) -> ca.MX:
    """The belief moved from the age `start` [s] to the age `end`: times before now, start >= end.

    Row j covers the ages [(N-1-j) T, (N-j) T]; the belief moves through the overlap of each row with [end, start].
    """
    oldest = ca.DM(list(range(SAMPLES, 0, -1))) * T
    overlap = ca.fmin(start, oldest) - ca.fmax(end, oldest - T)
    for row, duration in zip(ca.horzsplit(rows[: READING.size, :]), ca.vertsplit(overlap), strict=True):
        belief = propagate_if()(duration > _NOTHING, belief, row, duration, process)
    return belief


def lever_at(rows: ca.MX, age: ca.MX, T: ca.MX) -> ca.MX:
    """The lever arm column at `age`, linear between the ends of the rows."""
    ends = ca.DM(list(range(SAMPLES - 1, -1, -1))) * T
    weights = ca.fmax(0, 1 - ca.fabs(age - ends) / T)
    return ca.mtimes(rows[READING.size :, :], weights)
