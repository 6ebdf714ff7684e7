"""The last samples, oldest first, and the belief worked through them again when a fix from the past arrives."""

from __future__ import annotations

from functools import cache

import casadi as ca

from fmukit.kernel import Layout, Parts, block
from fmus.estimator.attitude import weigh
from fmus.estimator.correction import correct
from fmus.estimator.navigation import BELIEF, propagate
from fmus.estimator.records import ASSUMED, ROW, VERDICT
from fmus.estimator.updating import Estimate
from fmus.estimator.wheels import roll

_CHUNK, _CHUNKS = 20, 21
ROWS = 1 + _CHUNK * _CHUNKS
REACH = ROWS - 2
"""Age in samples of the oldest row that fixes may belong to: 2.1 s at 5 ms. The row before it is where it begins."""
RUNNER = Layout(belief=BELIEF.size, checkpoint=BELIEF.size, verdict=VERDICT.size)
"""What runs through the rows: the belief, its copy from the row `kept` before the fixes there, and the verdicts."""


@block(belief=BELIEF.size, before=ROW, row=ROW, assumed=ASSUMED)
def advance(belief: ca.SX, before: Parts, row: Parts, assumed: Parts) -> ca.SX:
    """The belief one row later, then told what the car's body says.

    It is moved by the mean rate of both ends and by the force of the later one, which is the mean in between.
    """
    a, b = before["sensed"]["unit"], row["sensed"]["unit"]
    mean = {"rate": 0.5 * (a["rate"] + b["rate"]), "force": b["force"]}
    return look(propagate(belief, mean, assumed["period"], assumed["process"]), row, assumed)


@block(belief=BELIEF, row=ROW, assumed=ASSUMED)
def look(belief: Parts, row: Parts, assumed: Parts) -> ca.SX:
    """The belief corrected by the suspension and the rear wheels of one row."""
    estimate, sensed = Estimate(belief), row["sensed"]
    weigh(estimate, sensed["tilt"], sensed["unit"]["force"], assumed["tilt"])
    roll(estimate, sensed["unit"], sensed["speed"], assumed["rolling"], assumed["arms"]["rear"])
    return estimate.column()


@block(symbol=ca.MX, belief=BELIEF.size, before=ROW.size, row=ROW.size, assumed=ASSUMED.size)
def stay(belief: ca.MX, before: ca.MX, row: ca.MX, assumed: ca.MX) -> ca.MX:
    """The belief as it is: what is taken in place of `advance`."""
    return belief


@block(symbol=ca.MX, belief=BELIEF.size, verdict=VERDICT.size, row=ROW.size, assumed=ASSUMED.size)
def believe(belief: ca.MX, verdict: ca.MX, row: ca.MX, assumed: ca.MX) -> tuple[ca.MX, ca.MX]:
    """Belief and verdicts as they are: what is taken in place of `correct`."""
    return belief, verdict


@cache
def advance_if() -> ca.Function:
    """(condition, belief, before, row, assumed) -> `advance` if the condition holds, else `stay`."""
    return ca.Function.if_else("advance_if", advance.function, stay.function)


def corrected(
    belief: ca.MX, verdict: ca.MX, row: ca.MX, assumed: ca.MX, condition: ca.MX | bool = True
) -> tuple[ca.MX, ca.MX]:
    """Belief and verdicts after the fixes that wait in the row, if any do and the condition holds."""
    r = ROW.split(row)
    some = r["place"]["heading_variance"] + r["place"]["position_variance"] + r["drift"]["velocity_variance"] > 0
    later = _correct_if()(ca.logic_and(some, condition), belief, verdict, row, assumed)
    return later[0], later[1]


@cache
def _correct_if() -> ca.Function:
    return ca.Function.if_else("correct_if", correct.function, believe.function)


def replay(belief: ca.MX, verdict: ca.MX, rows: ca.MX, start: ca.MX, kept: ca.MX, assumed: ca.MX) -> Parts:
    """RUNNER after all rows (ROW.size x ROWS) from the age `start` [samples] on, where `belief` is not fixed yet.

    `kept` is the age at which the new checkpoint is left, at most `start`.
    """
    runner = ca.vertcat(belief, belief, verdict)
    for first in range(0, ROWS - 1, _CHUNK):
        age = ROWS - 1 - first
        runner = _pass_if()(
            start >= age - _CHUNK, runner, rows[:, first : first + _CHUNK + 1], age, start, kept, assumed
        )
    parts: Parts = RUNNER.split(runner)
    return parts


@cache
def _pass_if() -> ca.Function:
    return ca.Function.if_else("pass_if", _pass.function, _skip.function)


_CHUNK_OF_ROWS: dict[str, int | tuple[int, int]] = {
    "runner": RUNNER.size,
    "rows": (ROW.size, _CHUNK + 1),
    "age": 1,
    "start": 1,
    "kept": 1,
    "assumed": ASSUMED.size,
}


@block(symbol=ca.MX, **_CHUNK_OF_ROWS)
def _pass(runner: ca.MX, rows: ca.MX, age: ca.MX, start: ca.MX, kept: ca.MX, assumed: ca.MX) -> ca.MX:
    """The runner after all rows of a chunk but the first, which has the age `age` [samples]."""
    x, columns = RUNNER.split(runner), ca.horzsplit(rows)
    belief, checkpoint, verdict = (x[name] for name in RUNNER.sizes)
    for k in range(1, _CHUNK + 1):
        belief = advance_if()(age - k < start, belief, columns[k - 1], columns[k], assumed)
        checkpoint = ca.if_else(age - k == kept, belief, checkpoint)
        belief, verdict = corrected(belief, verdict, columns[k], assumed, age - k <= start)
    return ca.vertcat(belief, checkpoint, verdict)


@block(symbol=ca.MX, **_CHUNK_OF_ROWS)
def _skip(runner: ca.MX, rows: ca.MX, age: ca.MX, start: ca.MX, kept: ca.MX, assumed: ca.MX) -> ca.MX:
    """The runner as it is: what is taken in place of `_pass`."""
    return runner
