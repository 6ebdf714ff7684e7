"""NavigationFilter: sense, move on, work through the past when a fix arrives, tell. Assembled from topic modules."""

from __future__ import annotations

from typing import Any

import casadi as ca

from fmukit.kernel import Kernel, Layout, Parts, Signals, block, sampled_kernel
from fmus.estimator.assumptions import assumptions, prior
from fmus.estimator.fixes import FIX, in_reach, present, put, reported
from fmus.estimator.history import REACH, ROWS, advance_if, corrected, look, replay
from fmus.estimator.interface import INTERFACE
from fmus.estimator.navigation import BELIEF
from fmus.estimator.records import ASSUMED, ROW, TALLY, VERDICT
from fmus.estimator.signals import outputs, sense

STATES = Layout(
    belief=BELIEF.size,
    checkpoint=BELIEF.size,
    checkpoint_age=1,
    rows=ROW.size * ROWS,
    started=1,
    last_count=1,
    verdict=VERDICT,
    tally=TALLY,
    refused_for=1,
)
"""`belief` is now; `checkpoint` is that at the older part of the last fix, before it (or as far back as fixes reach),
its age in samples."""
DERIVED = Layout(assumed=ASSUMED.size)
_MEMORY = ("belief", "checkpoint", "checkpoint_age", "rows", "verdict", "tally")
_BRANCH: dict[str, int | Layout] = {name: STATES.sizes[name] for name in _MEMORY}
_BRANCH |= {"fix": FIX.size, "assumed": ASSUMED.size, "patience": 1}


def kernel() -> Kernel:
    """The kernel; d holds what is assumed."""
    return sampled_kernel(INTERFACE, states=STATES, derived=DERIVED, initialise=initialise, sample=sample, symbol=ca.MX)


def initialise(p: Signals, u: Signals) -> tuple[Parts, Parts, Parts]:
    """The prior, as told before any fix."""
    belief = prior(p)
    x = {"belief": belief, "checkpoint": belief, "verdict": {"nis": ca.MX.zeros(3), "accepted": ca.MX.ones(3)}}
    return {"assumed": assumptions(p)}, x, _tell(p, u, STATES.split(STATES.begun(x)))


def sample(p: Signals, d: Parts, u: Signals, x: Parts, t: ca.MX) -> tuple[Parts, Parts]:
    """Sense, move on, correct when a fix arrives, tell."""
    assumed, count = d["assumed"], u["gps.fix_count"]
    later = _move_on(x, ROW.begun({"sensed": sense(p, u)}), assumed)
    fix = FIX.join(reported(p, u, t))
    is_new = ca.logic_and(count != x["last_count"], u["gps.valid"] > 0.5)
    choose = ca.Function.if_else("choose", _correct_the_past.function, _leave.function)
    memory = [_column(later[name]) for name in _MEMORY]
    new = choose(is_new, *memory, fix, assumed, p["gate.patience"])
    later |= dict(zip(_MEMORY, new, strict=True)) | {"last_count": count, "started": ca.MX(1)}
    later |= {"verdict": VERDICT.split(later["verdict"]), "tally": TALLY.split(later["tally"])}
    waited = x["refused_for"] + x["started"] * p["sample_period"]
    later["refused_for"] = ca.if_else(later["tally"]["in_a_row"] > 0, waited, 0)
    return later, _tell(p, u, later)


def _move_on(x: Parts, row: ca.MX, assumed: ca.MX) -> Parts:
    """The belief at the newest sample, which `row` is, and the checkpoint moved on before its row is dropped."""
    started = x["started"]
    columns: Any = ca.vertsplit(x["rows"], ROW.size)
    first = look(x["belief"], row, assumed)
    moved = advance_if()(started, x["belief"], columns[-1], row, assumed)
    late = x["checkpoint_age"] >= REACH
    oldest, following = columns[ROWS - 1 - REACH], columns[ROWS - REACH]
    seen, _ = corrected(x["checkpoint"], _column(x["verdict"]), oldest, assumed, late)
    begun = ca.if_else(started, x["checkpoint"], first)
    return x | {
        "belief": ca.if_else(started, moved, first),
        "checkpoint": ca.if_else(late, advance_if()(late, seen, oldest, following, assumed), begun),
        "checkpoint_age": ca.fmin(x["checkpoint_age"] + started, REACH),
        "rows": ca.vertcat(x["rows"][ROW.size :], row),
    }


def _column(parts: Parts | ca.MX) -> ca.MX:
    return ca.vertcat(*map(_column, parts.values())) if isinstance(parts, dict) else parts


@block(symbol=ca.MX, **_BRANCH)
def _leave(**a: ca.MX) -> tuple[ca.MX, ...]:
    """No fix: all as it is."""
    return tuple(a[name] for name in _MEMORY)


@block(symbol=ca.MX, **_BRANCH)
def _correct_the_past(**a: ca.MX) -> tuple[ca.MX, ...]:
    """A fix: its parts into their rows, and from the checkpoint through all rows to now."""
    fix, start, tally = FIX.split(a["fix"]), a["checkpoint_age"], TALLY.split(a["tally"])
    doubt = tally["doubted"] >= a["patience"]
    rows = put(ca.reshape(a["rows"], ROW.size, ROWS), fix, start, doubt)
    kept = ca.fmin(ca.fmax(fix["place_age"], fix["drift_age"]), start)
    run = replay(a["checkpoint"], a["verdict"], rows, start, kept, a["assumed"])
    there, reach = present(fix), in_reach(fix, start)
    accepted = VERDICT.split(run["verdict"])["accepted"]
    good = ca.logic_and(reach, accepted)
    refused, some = ca.sum1(ca.logic_and(there, ca.logic_not(good))) > 0, ca.sum1(there) > 0
    unlikely = ca.sum1(ca.logic_and(ca.logic_and(there, reach), ca.logic_not(accepted))) > 0
    counted = {
        "used": tally["used"] + ca.logic_and(some, ca.logic_not(refused)),
        "refused": tally["refused"] + refused,
        "in_a_row": ca.if_else(some, refused * (tally["in_a_row"] + 1), tally["in_a_row"]),
        "doubted": ca.if_else(some, unlikely * (tally["doubted"] + 1), tally["doubted"]),  # not what is too old
    }
    return run["belief"], run["checkpoint"], kept, ca.vec(rows), run["verdict"], TALLY.join(counted)


def _tell(p: Signals, u: Signals, x: Parts) -> Parts:
    told: Parts = outputs(p, u, x["belief"], x["verdict"], x["tally"], x["refused_for"])
    return told
