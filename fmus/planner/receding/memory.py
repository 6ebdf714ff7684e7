"""The plan as it is remembered from sample to sample, and its form as a column of numbers of fixed length."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import astuple, dataclass, field, fields, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .layout import INPUTS, STATES

Array = NDArray[np.float64]
CAPACITY = 128
"""Nodes of the plan from now on."""
PLANNING, ENDED, BRAKED = 0, 1, 2
"""Phases: more is planned as time goes on; the end of the road is planned; given up, the car brakes to a stop."""


@dataclass(frozen=True, slots=True)
class Record:
    """What happened so far; `status` to `slack` are of the last local problem."""

    count: int = 0
    failed: int = 0
    fallbacks: int = 0
    fallback: int = 0
    replans: int = 0
    status: int = 0
    iterations: int = 0
    time: float = 0.0
    violation: float = 0.0
    slack: float = 0.0
    final_time: float = 0.0


@dataclass(frozen=True, slots=True)
class Tail:
    """What the last local problem planned beyond the accepted part: `x` (k, 7) after intervals `T` (k,) with `u`."""

    x: Array
    u: Array
    T: Array


@dataclass(frozen=True, slots=True)
class RollingPlan:
    """Nodes at `times` (n,) [s] with states `x` (n, 7) in the world; `u` (n, 3) holds from each node on.

    The last node is at gate number `gate`; its input is that of the interval before. `bend` [1/m] is the curvature of
    a car that brakes.
    """

    times: Array
    x: Array
    u: Array
    gate: int
    phase: int = PLANNING
    bend: float = 0.0
    tail: Tail = field(default_factory=lambda: Tail(np.zeros((0, STATES)), np.zeros((0, INPUTS)), np.zeros(0)))
    record: Record = field(default_factory=Record)

    @property
    def end(self) -> float:
        """Time [s] of the last node."""
        return float(self.times[-1])

    def joined(self, x: Array, u: Array, T: Array) -> RollingPlan:
        """With k more intervals: states (k, 7) at their ends, inputs (k, 3), lengths (k,) [s]."""
        return replace(
            self,
            times=np.concatenate([self.times, self.end + np.cumsum(T)]),
            x=np.vstack([self.x, x]),
            u=np.vstack([self.u[:-1], u, u[-1:]]),
            gate=self.gate + len(T),
        )

    def since(self, t: float) -> RollingPlan:
        """Without the nodes that are no longer needed at time t [s] or later."""
        k = int(np.clip(np.searchsorted(self.times, t, side="right") - 1, 0, len(self.times) - 1))
        return replace(self, times=self.times[k:], x=self.x[k:], u=self.u[k:])


_HEAD = 5
_RECORD = len(fields(Record))
_ROW = 1 + STATES + INPUTS


def size(horizon: int) -> int:
    """Length of the column, for local problems of `horizon` intervals."""
    return _HEAD + _RECORD + _ROW * (CAPACITY + horizon)


def to_numbers(plan: RollingPlan, horizon: int) -> Array:
    """The plan as `size(horizon)` numbers; raises ValueError when it has too many nodes."""
    n, k = len(plan.times), len(plan.tail.T)
    if n > CAPACITY:
        raise ValueError(f"the plan has {n} nodes, but there is room for {CAPACITY}; give a larger road.spacing")
    rows = np.zeros((CAPACITY + horizon, _ROW))
    rows[:n] = np.column_stack([plan.times, plan.x, plan.u])
    rows[CAPACITY : CAPACITY + k] = np.column_stack([plan.tail.T, plan.tail.x, plan.tail.u])
    head = n, k, plan.gate, plan.phase, plan.bend, *astuple(plan.record)
    return np.concatenate([np.array(head, dtype=float), rows.ravel()])


def from_numbers(numbers: Sequence[float], horizon: int) -> RollingPlan:
    """The plan that was made these numbers."""
    column = np.asarray(numbers)
    n, k, gate, phase = (int(value) for value in column[:4])
    values: list[Any] = [_as(f.type, column[_HEAD + j]) for j, f in enumerate(fields(Record))]
    rows = column[_HEAD + _RECORD :].reshape(CAPACITY + horizon, _ROW)
    T, later, inputs = _columns(rows[CAPACITY : CAPACITY + k])
    tail, record = Tail(later, inputs, T), Record(*values)
    return RollingPlan(*_columns(rows[:n]), gate, phase, float(column[4]), tail, record)


def _columns(rows: Array) -> tuple[Array, Array, Array]:
    """Times or lengths (n,), states (n, 7) and inputs (n, 3) of the rows."""
    return rows[:, 0], rows[:, 1 : 1 + STATES], rows[:, 1 + STATES :]


def _as(kind: object, value: float) -> float:
    return int(value) if kind == "int" else float(value)
