"""How runs of formations are summed up, and that one runs."""

from __future__ import annotations

import sys

import pytest

from benchmarks import formation_scaling
from benchmarks.formation_scaling import Run, compared


def test_every_turn_counts_as_it_went_in_its_best_round() -> None:
    first = [
        Run(1, processor=[0.020, 0.050], wall=[0.04, 0.06], memory=100.0, initialised=90.0),
        Run(2, processor=[0.021, 0.055], wall=[0.02, 0.08], memory=110.0, initialised=95.0),
        Run(10, processor=[0.022, 0.060], wall=[0.02, 0.08], memory=130.0, initialised=109.0),
    ]
    other = [
        Run(1, processor=[0.080, 0.020], wall=[0.10, 0.10], memory=104.0, initialised=91.0),
        Run(2, processor=[0.080, 0.020], wall=[0.10, 0.10], memory=108.0, initialised=96.0),
        Run(10, processor=[0.080, 0.022], wall=[0.05, 0.03], memory=127.0, initialised=108.0),
    ]
    seen = compared([first, other])
    assert list(seen) == [1, 2, 10]
    assert (seen[1].cost, seen[10].cost) == (0.020, 0.022)
    assert (seen[1].ratio, seen[10].ratio) == (1.0, pytest.approx(1.1))
    assert (seen[2].second, seen[10].second) == (1.0, pytest.approx(0.022 / 0.0205))
    assert seen[10].usual == pytest.approx(0.5 * (0.082 / 0.070 + 0.102 / 0.100))
    assert (seen[10].memory, seen[10].instances) == (pytest.approx(3.0), pytest.approx(2.0))
    assert seen[10].real_time_factor == pytest.approx(1.0 / 0.22)
    assert seen[10].seen == pytest.approx(1.0 / 0.4)


@pytest.mark.skipif(sys.platform != "linux", reason="memory is told by Linux")
def test_formations_take_turns_of_equal_length(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every size is timed over, and holds the results of, the same simulated time."""
    ends = []
    whole = formation_scaling.run
    monkeypatch.setattr(formation_scaling, "run", lambda of, **more: (ends.append(of.stop), whole(of, **more))[1])
    waits: list[None] = []
    formation_scaling._here(1, 3, lambda: None, length=64_000_000)
    run = formation_scaling._here(2, 3, lambda: waits.append(None), length=64_000_000)
    assert ends == [5 * 64_000_000] * 2
    assert (run.cars, len(run.processor), len(run.wall), len(waits)) == (2, 3, 3, 4)
    assert min(run.processor) > 0.0
    assert 30.0 < run.initialised <= run.memory + 2.0 < 2000.0, "Linux counts the two to within some pages"


@pytest.mark.nightly
def test_two_sizes_side_by_side() -> None:
    seen = formation_scaling.measure(rounds=1, sizes=(1, 2))
    assert list(seen) == [1, 2]
    assert 0.3 < seen[2].ratio < 3.0
