"""How runs of formations are summed up, and that one runs."""

from __future__ import annotations

import sys

import pytest

from benchmarks import formation_scaling
from benchmarks.formation_scaling import Run, compared, seconds


def test_the_best_of_each_size_is_held_against_the_best_of_one_car() -> None:
    runs = [
        Run(1, processor=0.040, wall=0.050, memory=100.0),
        Run(10, processor=0.090, wall=0.020, memory=130.0),
        Run(1, processor=0.020, wall=0.080, memory=104.0),
        Run(10, processor=0.022, wall=0.025, memory=127.0),
    ]
    seen = compared(runs)
    assert list(seen) == [1, 10]
    assert (seen[1].cost, seen[10].cost) == (0.020, 0.022)
    assert seen[10].ratio == pytest.approx(1.1)
    assert seen[10].memory == pytest.approx(3.0)
    assert seen[10].real_time_factor == pytest.approx(5.0)
    assert seen[1].ratio == 1.0
    assert seen[1].memory != seen[1].memory, "one car is not more than itself"


def test_work_is_about_equal_and_never_nothing() -> None:
    assert [seconds(cars) for cars in (1, 2, 5, 10, 20, 50)] == [20.0, 20.0, 8.0, 4.0, 2.0, 2.0]


@pytest.mark.skipif(sys.platform != "linux", reason="memory is told by Linux")
def test_two_cars_run_in_a_process_of_their_own() -> None:
    run = formation_scaling._elsewhere(2, 0.5)
    assert run.cars == 2
    assert run.processor > 0.0
    assert run.wall > 0.0
    assert 30.0 < run.memory < 1000.0
