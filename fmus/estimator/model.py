"""NavigationFilter: sense, move on, correct when a fix arrives, tell. Assembled from the topic modules."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, sampled_kernel
from fmus.estimator.correction import FIX, TRUST, correct
from fmus.estimator.history import ROW, SAMPLES, lever_at, transport
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import BELIEF, PACKED, PROCESS, READING, propagate
from fmus.estimator.signals import SENSED, assumptions, outputs, prior, sense

STATES = Layout(
    belief=BELIEF.size,
    checkpoint=BELIEF.size,
    checkpoint_age=1,
    sensed=SENSED.size,
    rows=ROW.size * SAMPLES,
    last_count=1,
    nis=2,
    used=1,
    refused=1,
    refused_in_a_row=1,
)
"""`belief` is now, `checkpoint` the posterior at the last used fix (or as far back as the rows reach)."""
DERIVED = Layout(process=PROCESS.size, trust=TRUST.size, initial=PACKED)
_MEMORY = ("belief", "checkpoint", "checkpoint_age", "nis", "used", "refused", "refused_in_a_row")


def kernel() -> Kernel:
    """The kernel; d holds the assumed noises and the initial covariance."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=_initialise(), step=_step())


def _initialise() -> ca.Function:
    p, u = (ca.MX.sym(name[0], len(INTERFACE.names(name))) for name in ("parameter", "input"))
    process, trust, initial = assumptions()(p)
    belief, sensed = prior()(p)
    x = {name: ca.MX.zeros(size) for name, size in STATES.sizes.items()}
    x |= {"belief": belief, "checkpoint": belief, "sensed": sensed}
    arguments = [p, u, ca.MX.sym("w", 0), ca.MX.sym("table", 0), ca.MX.sym("rows")]
    results = [ca.vertcat(process, trust, initial), ca.vertcat(*x.values()), _tell(p, u, x)]
    return ca.Function("initialise", arguments, results)


def _step() -> ca.Function:
    p, u = (ca.MX.sym(name[0], len(INTERFACE.names(name))) for name in ("parameter", "input"))
    d, state, t = ca.MX.sym("d", DERIVED.size), ca.MX.sym("x", STATES.size), ca.MX.sym("t")
    x = _named(state, STATES)
    x = _move_on(p, u, _named(d, DERIVED), x, t)
    return ca.Function(
        "step", [p, d, u, state, ca.MX.sym("w", 0), t], [ca.vertcat(*(x[n] for n in STATES.sizes)), _tell(p, u, x)]
    )


def _move_on(p: ca.MX, u: ca.MX, d: dict[str, ca.MX], x: dict[str, ca.MX], t: ca.MX) -> dict[str, ca.MX]:
    """Attitude, history, then either one step ahead or the correction of the past."""
    sensed, row, T, period, fix, age, count, valid = sense()(p, u, x["sensed"], t)
    checkpoint, checkpoint_age = _keep_within_reach(d, x, period)
    x = x | {"sensed": sensed, "checkpoint": checkpoint, "checkpoint_age": checkpoint_age + T}
    x["rows"] = ca.vertcat(x["rows"][ROW.size :], row)
    is_new = ca.logic_and(count != x["last_count"], valid > 0.5)
    in_reach = ca.logic_and(age <= x["checkpoint_age"] + 1e-6, age <= (SAMPLES - 1) * period)
    memory = [x[name] for name in _MEMORY]
    choose = ca.Function.if_else("choose", _correct_the_past(), _step_ahead())
    new = choose(ca.logic_and(is_new, in_reach), *memory, x["rows"], *d.values(), T, period, fix, age)
    x |= dict(zip(_MEMORY, new, strict=True)) | {"last_count": count}
    return x | {"refused": x["refused"] + ca.logic_and(is_new, ca.logic_not(in_reach))}


def _keep_within_reach(d: dict[str, ca.MX], x: dict[str, ca.MX], period: ca.MX) -> tuple[ca.MX, ca.MX]:
    """Move the checkpoint through the oldest row before that row is dropped."""
    reach = (SAMPLES - 1) * period
    move = ca.Function.if_else("move", propagate(), _unmoved())
    moved = move(
        x["checkpoint_age"] > reach + 1e-9,
        x["checkpoint"],
        x["rows"][: READING.size],
        x["checkpoint_age"] - reach,
        d["process"],
    )
    return moved, ca.fmin(x["checkpoint_age"], reach)


def _unmoved() -> ca.Function:
    belief = ca.MX.sym("b", BELIEF.size)
    rest = [ca.MX.sym("reading", READING.size), ca.MX.sym("T"), ca.MX.sym("q", PROCESS.size)]
    return ca.Function("unmoved", [belief, *rest], [belief])


def _branch_arguments() -> dict[str, ca.MX]:
    sizes = {name: STATES.sizes[name] for name in (*_MEMORY, "rows")} | DERIVED.sizes
    sizes |= {"T": 1, "period": 1, "fix": FIX.size, "age": 1}
    return {name: ca.MX.sym(name, size) for name, size in sizes.items()}


def _step_ahead() -> ca.Function:
    """No fix: the belief moves through the newest row."""
    a = _branch_arguments()
    belief = propagate()(a["belief"], a["rows"][-ROW.size :][: READING.size], a["T"], a["process"])
    return ca.Function("step_ahead", list(a.values()), [belief, *(a[name] for name in _MEMORY[1:])])


def _correct_the_past() -> ca.Function:
    """A fix: checkpoint to the instant of the fix, both updates, and on to now."""
    a, move = _branch_arguments(), transport(propagate())
    rows, now = ca.reshape(a["rows"], ROW.size, SAMPLES), ca.MX(0)
    before = move(a["checkpoint"], rows, a["checkpoint_age"], a["age"], a["period"], a["process"])
    doubt = a["refused_in_a_row"] >= a["trust"][TRUST.size - 1]
    lever = lever_at(rows, a["age"], a["period"])
    after, nis, accepted = correct()(before, a["fix"], lever, a["trust"], doubt, a["initial"])
    belief = move(after, rows, a["age"], now, a["period"], a["process"])
    good = ca.logic_and(accepted[0], accepted[1])
    counts = [a["used"] + good, a["refused"] + 1 - good, (1 - good) * (a["refused_in_a_row"] + 1)]
    return ca.Function("correct_the_past", list(a.values()), [belief, after, a["age"], nis, *counts])


def _tell(p: ca.MX, u: ca.MX, x: dict[str, ca.MX]) -> ca.MX:
    return outputs()(p, u, x["belief"], x["sensed"], x["nis"], x["used"], x["refused"])


def _named(column: ca.MX, layout: Layout) -> dict[str, ca.MX]:
    """Named slices of an MX column."""
    ends = [0]
    for size in layout.sizes.values():
        ends.append(ends[-1] + size)
    return dict(zip(layout.sizes, ca.vertsplit(column, ends), strict=True))
