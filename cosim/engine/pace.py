"""A run at the pace of a clock on the wall: each tick waits for its time, and how late it came is kept."""

from __future__ import annotations

import time as wall
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from cosim.engine.order import Tick
from cosim.model.clock import to_seconds

_LATE = 1e-3
"""[s] A tick that comes so much after its time is an overrun."""
_SLICE = 0.05
"""[s] Longest sleep, after which the wall clock is asked again."""


@dataclass(slots=True)
class Pace:
    """`factor` simulated seconds per second of the wall.

    Of the `ticks` so far `overruns` began more than 1 ms late; `latest` [s] is how late the worst of them was.
    """

    factor: float = 1.0
    ticks: int = 0
    overruns: int = 0
    latest: float = 0.0
    now: Callable[[], float] = wall.perf_counter
    sleep: Callable[[float], None] = wall.sleep

    def paced(self, ticks: Iterator[Tick], interrupted: Callable[[], bool] = lambda: False) -> Iterator[Tick]:
        """The ticks, each no sooner than its time; the clock starts with the first of them."""
        start: float | None = None
        for time, order in ticks:
            start = self.now() - to_seconds(time) / self.factor if start is None else start
            self._wait(start + to_seconds(time) / self.factor, interrupted)
            yield time, order

    def _wait(self, due: float, interrupted: Callable[[], bool]) -> None:
        while (left := due - self.now()) > 0.0 and not interrupted():
            self.sleep(min(left, _SLICE))
        late = self.now() - due
        self.ticks += 1
        self.overruns += late > _LATE
        self.latest = max(self.latest, late)
