"""Times with an aim stay within three times of it, so that a machine may be slow but a program may not.

Ratios of times measured in turns, which a slow machine leaves as they are, stay within a tenth of theirs.
Means count everything; of the worst case the best of several rounds, which another program cannot spoil.
"""

from __future__ import annotations

import pytest

from benchmarks import formation_scaling, mpc_sample, planning, qp_in_fmu

pytestmark = pytest.mark.nightly
_SLOW, _UNEVEN = 3.0, 1.1


def test_solvers_of_mpc_allocator_inside_the_fmu() -> None:
    found, exchange = qp_in_fmu.measure(rounds=3)
    for name, seen in found.items():
        assert 0.0 < seen.time.mean <= _SLOW * qp_in_fmu.MEAN[name]
        assert seen.time.best_mean <= seen.time.best_worst <= seen.time.worst
    for name, limit in qp_in_fmu.WORST.items():
        assert found[name].time.best_worst <= _SLOW * limit
    assert exchange > sum(seen.time.mean for seen in found.values())


def test_a_compiled_sample_is_faster_than_an_interpreted_one() -> None:
    compiled, interpreted = mpc_sample.measure(rounds=2)
    assert compiled.best_mean < interpreted.best_mean


@pytest.mark.parametrize(("grid", "m"), planning.AIMS)
def test_plans_after_compilation(grid: planning.Grid, m: int) -> None:
    seen = planning.measure(grid, m, rounds=3)
    assert seen.compiled.seconds <= _SLOW * planning.AIMS[grid, m]
    assert seen.compiled.processor < seen.interpreted.processor


def test_formations_cost_what_their_cars_cost() -> None:
    seen = formation_scaling.measure(rounds=2, sizes=(1, formation_scaling.CARS, 50))
    assert seen[50].ratio <= _UNEVEN * formation_scaling.RATIO
    assert seen[50].memory <= formation_scaling.MEMORY
    assert seen[formation_scaling.CARS].real_time_factor >= formation_scaling.REAL_TIME / _SLOW
