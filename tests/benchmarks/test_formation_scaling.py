"""How runs of formations are summed up, and that one runs."""

from __future__ import annotations

import sys

import pytest

from benchmarks import formation_scaling
from benchmarks.formation_scaling import Run, compared


def test_every_turn_counts_as_it_went_in_its_best_round() -> None:
    first = [
        Run(1, processor=[0.020, 0.050], wall=[0.04, 0.06], memory=100.0),
        Run(10, processor=[0.022, 0.060], wall=[0.02, 0.08], memory=130.0),
    ]
    other = [
        Run(1, processor=[0.080, 0.020], wall=[0.10, 0.10], memory=104.0),
        Run(10, processor=[0.080, 0.022], wall=[0.05, 0.03], memory=127.0),
    ]
    seen = compared([first, other])
    assert list(seen) == [1, 10]
    assert (seen[1].cost, seen[10].cost) == (0.020, 0.022)
    assert (seen[1].ratio, seen[10].ratio) == (1.0, pytest.approx(1.1))
    assert seen[10].memory == pytest.approx(3.0)
    assert seen[10].real_time_factor == pytest.approx(1.0 / 0.22)
    assert seen[10].seen == pytest.approx(1.0 / 0.4)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is told by Linux")
def test_formations_take_turns() -> None:
    waits: list[None] = []
    run = formation_scaling._here(2, 3, lambda: waits.append(None))
    assert (run.cars, len(run.processor), len(run.wall), len(waits)) == (2, 3, 3, 4)
    assert min(run.processor) > 0.0
    assert 30.0 < run.memory < 2000.0


@pytest.mark.nightly
def test_two_sizes_side_by_side() -> None:
    seen = formation_scaling.measure(rounds=1, sizes=(1, 2))
    assert list(seen) == [1, 2]
    assert 0.3 < seen[2].ratio < 3.0
