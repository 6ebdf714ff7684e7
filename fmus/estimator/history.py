"""The last samples, oldest first, and moving a belief from any time to any time over them."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Layout
from fmus.estimator.correction import LEVER
from fmus.estimator.navigation import BELIEF, PROCESS, READING

SAMPLES = 80
"""Rows kept: 0.4 s at 5 ms."""
ROW = Layout(reading=READING.size, lever=LEVER.size)
"""`reading` is the mean over the interval that ends with the sample, `lever` belongs to its end."""
_NOTHING = 1e-9  # s, shorter intervals are skipped


def transport(propagate: ca.Function) -> ca.Function:
    """(belief, rows, from age, to age, T, process) -> belief; ages are times before now, from >= to.

    Row j covers the ages [(N-1-j) T, (N-j) T]; the belief moves through the overlap of each row with [to, from].
    """
    belief, rows = ca.MX.sym("b", BELIEF.size), ca.MX.sym("rows", ROW.size, SAMPLES)
    start, end, T, process = ca.MX.sym("from"), ca.MX.sym("to"), ca.MX.sym("T"), ca.MX.sym("q", PROCESS.size)
    oldest = ca.DM(list(range(SAMPLES, 0, -1))) * T
    overlap = ca.fmin(start, oldest) - ca.fmax(end, oldest - T)
    through, moved = _through(propagate), belief
    durations = ca.vertsplit(overlap)
    for row, duration in zip(ca.horzsplit(rows[: READING.size, :]), durations, strict=True):
        moved = through(duration > _NOTHING, moved, row, duration, process)
    return ca.Function("transport", [belief, rows, start, end, T, process], [moved])


def lever_at(rows: ca.MX, age: ca.MX, T: ca.MX) -> ca.MX:
    """The lever arm column at `age`, linear between the ends of the rows."""
    ends = ca.DM(list(range(SAMPLES - 1, -1, -1))) * T
    weights = ca.fmax(0, 1 - ca.fabs(age - ends) / T)
    return ca.mtimes(rows[READING.size :, :], weights)


def _through(propagate: ca.Function) -> ca.Function:
    """`propagate` behind a short-circuit condition; otherwise the belief as it is."""
    arguments = [ca.MX.sym(propagate.name_in(i), propagate.sparsity_in(i)) for i in range(propagate.n_in())]
    stay = ca.Function("stay", arguments, [arguments[0]])
    return ca.Function.if_else("through", propagate, stay)
