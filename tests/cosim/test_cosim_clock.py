import pytest

from cosim.errors import CosimError
from cosim.model.clock import base_tick, hyperperiod, nanoseconds, to_seconds


@pytest.mark.parametrize(
    ("seconds", "expected"), [(0.001, 1_000_000), (0.1 + 0.2, 300_000_000), (1e-9, 1), (3600.0, 3_600_000_000_000)]
)
def test_seconds_become_whole_nanoseconds(seconds, expected):
    assert nanoseconds(seconds, "x") == expected


@pytest.mark.parametrize("seconds", [1 / 3, 1.5e-9, 0.0, -1.0, float("nan"), float("inf")])
def test_other_periods_are_refused_by_name(seconds):
    with pytest.raises(CosimError, match="the period of hlc"):
        nanoseconds(seconds, "the period of hlc")


def test_base_tick_and_hyperperiod():
    periods = [nanoseconds(s, "x") for s in (0.005, 0.002, 0.02)]
    assert base_tick(periods) == 1_000_000
    assert hyperperiod(periods) == 20_000_000


def test_a_million_ticks_carry_no_error():
    assert to_seconds(1_000_000 * 1_000_000) == 1000.0
    assert to_seconds(300_000_000) == 0.3
