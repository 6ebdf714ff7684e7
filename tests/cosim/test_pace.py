"""A run at the pace of a clock, here one that tests wind: waiting, lateness, and what is kept of it."""

from __future__ import annotations

import pytest
from cosim_mocks import Mock, face, mastered

from cosim.engine.pace import Pace
from cosim.model.clock import SECOND
from cosim.model.system import System


class Clock:
    """Time passes while somebody sleeps or works."""

    def __init__(self) -> None:
        self.time = 5.0
        self.slept = 0.0

    def now(self) -> float:
        return self.time

    def sleep(self, duration: float) -> None:
        self.time += duration
        self.slept += duration


def driven(factor: float, work: float) -> tuple[Clock, Pace, list[float]]:
    """Ten steps of 0.1 s, each of which takes `work` [s] of the wall."""
    clock, began = Clock(), []

    def step(_time: float, _length: float, _held: object) -> dict[str, float]:
        began.append(clock.time - 5.0)
        clock.time += work
        return {"y": 0.0}

    system = System()
    system.add("one", "Mock")
    master, _ = mastered(system, {"one": Mock(face(outputs={"y": "m"}, step=0.1), step)})
    pace = Pace(factor, now=clock.now, sleep=clock.sleep)
    outcome = master.run(SECOND, lambda: None, pace=pace)
    assert outcome.status == "ok"
    return clock, pace, began


@pytest.mark.parametrize("factor", [1.0, 4.0])
def test_every_tick_waits_for_its_time(factor: float) -> None:
    _, pace, began = driven(factor, 0.01)
    assert began == pytest.approx([0.1 * k / factor for k in range(10)], abs=1e-9)
    assert (pace.ticks, pace.overruns) == (10, 0)
    assert pace.latest == pytest.approx(0.0, abs=1e-9)


def test_late_ticks_are_counted_and_do_not_wait() -> None:
    """Work of 0.15 s per 0.1 s: tick k comes 0.05 k late."""
    clock, pace, began = driven(1.0, 0.15)
    assert began == pytest.approx([0.15 * k for k in range(10)])
    assert (pace.ticks, pace.overruns) == (10, 9)
    assert pace.latest == pytest.approx(0.45) and clock.slept == 0.0


def test_a_run_that_goes_on_does_not_wait_for_what_was_before() -> None:
    clock = Clock()
    pace = Pace(2.0, now=clock.now, sleep=clock.sleep)
    list(pace.paced(iter([(600 * SECOND, None), (601 * SECOND, None)])))  # type: ignore[list-item]
    assert clock.slept == pytest.approx(0.5)


def test_an_interrupt_ends_the_waiting() -> None:
    clock = Clock()
    pace = Pace(1e-6, now=clock.now, sleep=clock.sleep)
    stop = lambda: clock.slept > 1.0  # noqa: E731
    list(pace.paced(iter([(0, None), (SECOND, None)]), stop))  # type: ignore[list-item]
    assert clock.slept < 1.2
