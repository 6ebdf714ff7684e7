"""NavigationFilter: sense, move on, correct when a fix arrives, tell. Assembled from the topic modules."""

from __future__ import annotations

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, block, sampled_kernel
from fmus.estimator.correction import FIX, TRUST, correct
from fmus.estimator.history import ROW, SAMPLES, lever_at, transport
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import BELIEF, PACKED, PROCESS, READING, propagate, propagate_if
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


_BRANCH = {name: STATES.sizes[name] for name in (*_MEMORY, "rows")} | DERIVED.sizes
_BRANCH |= {"T": 1, "period": 1, "fix": FIX.size, "age": 1}
"""What both ways of a sample take, see `_move_on`."""


def kernel() -> Kernel:
    """The kernel; d holds the assumed noises and the initial covariance."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=initialise, sample=sample, symbol=ca.MX)


def initialise(p: Signals, u: Signals) -> tuple[Parts, Parts, Parts]:
    """The prior, as told before any fix."""
    belief, sensed = prior(p)
    x = {"belief": belief, "checkpoint": belief, "sensed": sensed}
    return dict(zip(DERIVED.sizes, assumptions(p), strict=True)), x, _tell(p, u, STATES.split(STATES.begun(x)))


def sample(p: Signals, d: Parts, u: Signals, x: Parts, t: ca.MX) -> tuple[Parts, Parts]:
    """Sense, move on, correct when a fix arrives, tell."""
    later = _move_on(p, u, d, x, t)
    return later, _tell(p, u, later)


def _move_on(p: Signals, u: Signals, d: Parts, x: Parts, t: ca.MX) -> Parts:
    """Attitude, history, then either one step ahead or the correction of the past."""
    period, count = p["sample_period"], u["gps.fix_count"]
    sensed, row, T, fix, age = sense(p, u, x["sensed"], t)
    checkpoint, checkpoint_age = _keep_within_reach(d, x, period)
    x = x | {"sensed": sensed, "checkpoint": checkpoint, "checkpoint_age": checkpoint_age + T}
    x["rows"] = ca.vertcat(x["rows"][ROW.size :], row)
    is_new = ca.logic_and(count != x["last_count"], u["gps.valid"] > 0.5)
    in_reach = ca.logic_and(age <= x["checkpoint_age"] + 1e-6, age <= (SAMPLES - 1) * period)
    choose = ca.Function.if_else("choose", _correct_the_past.function, _step_ahead.function)
    memory = [x[name] for name in _MEMORY]
    new = choose(ca.logic_and(is_new, in_reach), *memory, x["rows"], *d.values(), T, period, fix, age)
    x |= dict(zip(_MEMORY, new, strict=True)) | {"last_count": count}
    return x | {"refused": x["refused"] + ca.logic_and(is_new, ca.logic_not(in_reach))}


def _keep_within_reach(d: Parts, x: Parts, period: ca.MX) -> tuple[ca.MX, ca.MX]:
    """Move the checkpoint through the oldest row before that row is dropped."""
    reach = (SAMPLES - 1) * period
    beyond, oldest = x["checkpoint_age"] - reach, x["rows"][: READING.size]
    late = x["checkpoint_age"] > reach + 1e-9
    moved = propagate_if()(late, x["checkpoint"], oldest, beyond, d["process"])
    return moved, ca.fmin(x["checkpoint_age"], reach)


@block(symbol=ca.MX, **_BRANCH)
def _step_ahead(**a: ca.MX) -> tuple[ca.MX, ...]:
    """No fix: the belief moves through the newest row."""
    belief = propagate(a["belief"], a["rows"][-ROW.size :][: READING.size], a["T"], a["process"])
    return belief, *(a[name] for name in _MEMORY[1:])


@block(symbol=ca.MX, **_BRANCH)
def _correct_the_past(**a: ca.MX) -> tuple[ca.MX, ...]:
    """A fix: checkpoint to the instant of the fix, both updates, and on to now."""
    rows, now = ca.reshape(a["rows"], ROW.size, SAMPLES), ca.MX(0)
    before = transport(a["checkpoint"], rows, a["checkpoint_age"], a["age"], a["period"], a["process"])
    doubt = a["refused_in_a_row"] >= TRUST.split(a["trust"])["patience"]
    lever = lever_at(rows, a["age"], a["period"])
    after, nis, accepted = correct(before, a["fix"], lever, a["trust"], doubt, a["initial"])
    belief = transport(after, rows, a["age"], now, a["period"], a["process"])
    good = ca.logic_and(accepted[0], accepted[1])
    counts = [a["used"] + good, a["refused"] + 1 - good, (1 - good) * (a["refused_in_a_row"] + 1)]
    return belief, after, a["age"], nis, *counts


def _tell(p: Signals, u: Signals, x: Parts) -> Parts:
    told: Parts = outputs(p, u, x["belief"], x["sensed"], x["nis"], x["used"], x["refused"])
    return told
