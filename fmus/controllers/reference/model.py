"""ReferenceTrajectory: one table of the trajectory, made at initialisation, looked up at every sample."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, sampled_kernel
from fmus.controllers.bus import PREVIEW, PREVIEW_PERIOD
from fmus.controllers.reference.interface import COLUMNS, INTERFACE, ROWS
from fmus.controllers.reference.manoeuvre import path
from fmus.controllers.reference.playback import canonical, lookup

STATES = Layout()
DERIVED = Layout(table=ROWS * len(COLUMNS), ends=2)
_PARAMETERS = INTERFACE.names("parameter")
_AHEAD = ca.DM([PREVIEW_PERIOD * k for k in range(PREVIEW + 1)])


def kernel() -> Kernel:
    """The kernel; d holds the table column by column and the times of its first and last row."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u, w = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("u", 0), ca.MX.sym("w", 0)
    file, rows = ca.MX.sym("table", len(COLUMNS), ROWS), ca.MX.sym("rows")
    from_file = canonical(file.T, rows)
    table = ca.if_else(rows > 0, from_file, path(_PARAMETERS, ROWS)(p))
    last = ca.if_else(rows > 0, rows, ROWS) - 1
    d = ca.vertcat(ca.vec(table), table[0, 0], ca.vec(table)[last])
    return ca.Function("initialise", [p, u, w, file, rows], [d, ca.MX(0, 1), _outputs(d, ca.MX(0))])


def _step() -> ca.Function:
    p, d, u = ca.MX.sym("p", len(_PARAMETERS)), ca.MX.sym("d", DERIVED.size), ca.MX.sym("u", 0)
    x, w, t = ca.MX.sym("x", 0), ca.MX.sym("w", 0), ca.MX.sym("t")
    return ca.Function("step", [p, d, u, x, w, t], [ca.MX(0, 1), _outputs(d, t)])


def _outputs(d: ca.MX, t: ca.MX) -> ca.MX:
    """The trajectory bus in slot order: now with its yaw rate, then the preview."""
    table, ends = ca.vertsplit(d, [0, ROWS * len(COLUMNS), DERIVED.size])
    values = lookup(PREVIEW + 1, ROWS)(table, ends, t + _AHEAD)
    now = values[:, 0]
    return ca.vertcat(now, now[3] * now[5], ca.vec(values[:, 1:]))
