"""ReferenceTrajectory: one table of the trajectory, made at initialisation, looked up at every sample."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, sampled_kernel
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD
from fmus.controllers.reference.interface import COLUMNS, INTERFACE, ROWS
from fmus.controllers.reference.manoeuvre import path
from fmus.controllers.reference.playback import canonical, lookup

DERIVED = Layout(
    table=ROWS * len(COLUMNS),  # column by column
    ends=2,  # times of its first and last row [s]
)
_AHEAD = ca.DM([PREVIEW_PERIOD * k for k in range(PREVIEW + 1)])


def kernel() -> Kernel:
    """The kernel; d holds the table."""
    return sampled_kernel(INTERFACE, derived=DERIVED, initialise=initialise, sample=sample, symbol=ca.MX)


def initialise(p: Signals, table: ca.MX, rows: ca.MX) -> tuple[Parts, Parts, ca.MX]:
    """The table of the file, or without one that of the manoeuvre."""
    chosen = ca.vec(ca.if_else(rows > 0, canonical(table.T, rows), path(p, ROWS)))
    last = ca.if_else(rows > 0, rows, ROWS) - 1
    d = {"table": chosen, "ends": ca.vertcat(chosen[0], chosen[last])}
    return d, {}, outputs(d, ca.MX(0))


def sample(d: Parts, t: ca.MX) -> tuple[Parts, ca.MX]:
    """The trajectory as it is from time t [s] on."""
    return {}, outputs(d, t)


def outputs(d: Parts, t: ca.MX) -> ca.MX:
    """The trajectory bus in slot order: now with its yaw rate, then the preview."""
    values = lookup(PREVIEW + 1, ROWS)(d["table"], d["ends"], t + _AHEAD)
    now = values[:, 0]
    return ca.vertcat(now, now[3] * now[5], ca.vec(values[:, 1:]))
