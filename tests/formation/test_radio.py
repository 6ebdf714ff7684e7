"""Radio: exact delays, order, losses and noise, against a queue in plain Python and against statistics."""

from __future__ import annotations

import math
from collections.abc import Mapping
from itertools import pairwise

import numpy as np
import pytest
from scipy import stats

from fmukit.direct import Direct
from fmukit.kernel import Kernel
from fmus.sensors.radio import COMPONENT

GRID = 0.01
MOTION = ("position.x", "position.y", "yaw", "velocity.x", "velocity.y", "yaw_rate")
CLEAN = {"loss.probability": 0.0} | {f"{name}.noise": 0.0 for name in ("position", "yaw", "velocity", "yaw_rate")}
Values = Mapping[str, float]


@pytest.fixture(scope="module")
def kernel() -> Kernel:
    return COMPONENT.kernel()


def sent(t: float) -> dict[str, float]:
    """What the sender knows at time t: no two instants alike, the yaw within half a turn."""
    values = (20 * t, 3 * math.sin(t), 2.5 * math.sin(0.3 * t), 20 + t, 0.1 * t, math.cos(t))
    return {f"message.{name}": value for name, value in zip(MOTION, values, strict=True)}


def received(kernel: Kernel, parameters: Values, duration: float, period: float = GRID) -> dict[str, np.ndarray]:
    """The outputs at every sample of `duration` [s], by the part of the name after `leader.`, and the time `t`."""
    radio = Direct(COMPONENT, parameters, kernel=kernel)
    rows = []
    for k in range(round(duration / period)):
        radio.set(sent(k * period))
        radio.sample(period)
        rows.append(radio.y)
    columns = np.array(rows).T
    names = [name.removeprefix("leader.") for name in COMPONENT.interface.names("output")]
    return dict(zip(names, columns, strict=True)) | {"t": period * np.arange(len(rows))}


def still(kernel: Kernel, parameters: Values, count: int) -> np.ndarray:
    """The errors (messages x 6) of `count` messages 20 ms apart, while all that is sent is zero."""
    settings = {"message_period": 0.02, "latency": 0.0, "loss.probability": 0.0, **parameters}
    radio, rows = Direct(COMPONENT, settings, kernel=kernel), []
    for _ in range(2 * count):
        radio.sample()
        rows.append(radio.y[:6])
    assert radio["leader.count"] == count
    errors = np.array(rows)
    np.testing.assert_array_equal(errors[::2], errors[1::2])  # held until the next message
    return errors[::2]


def test_age_is_a_sawtooth_from_latency_to_latency_plus_period(kernel: Kernel) -> None:
    y = received(kernel, {**CLEAN}, 1.0)
    milliseconds = np.rint(1000 * y["age"]).astype(int)
    assert list(milliseconds) == [0, 10, *([20, 30, 40, 50, 60, 70, 80, 90, 100, 110] * 10)[:98]]
    np.testing.assert_allclose(1000 * y["age"], milliseconds, atol=1e-9)
    assert list(y["valid"]) == [0, 0] + [1] * 98
    assert list(y["count"]) == [0, 0, *np.repeat(np.arange(1, 11), 10)[:98]]
    assert not any(y[name][:2].any() for name in MOTION)


@pytest.mark.parametrize("seed", range(6))
def test_messages_are_those_of_a_plain_queue(kernel: Kernel, seed: int) -> None:
    """Any period, latency, outage and sampling period; what arrives is what was sent, in order, to the bit."""
    rng = np.random.default_rng(seed)
    period, latency, grid = rng.uniform(0.02, 0.4), rng.uniform(0, 0.5), rng.choice([0.005, 0.01, 0.03, 0.15])
    start, length = rng.uniform(0, 2), rng.uniform(0, 1)
    settings = {"message_period": period, "latency": latency, "sample_period": grid}
    y = received(kernel, {**CLEAN, **settings, "outage.start": start, "outage.duration": length}, 4.0, grid)
    under_way, newest, count, next_due = [], None, 0, 0
    for k, t in enumerate(y["t"]):
        if t + 1e-7 >= next_due * period:
            under_way.append(t)
            next_due = math.floor((t + 1e-7) / period) + 1
        while under_way and under_way[0] + latency <= t + 1e-7:
            arrived = under_way.pop(0)
            if not start <= arrived + 1e-7 < start + length:
                newest, count = arrived, count + 1
        assert (y["count"][k], y["valid"][k]) == (count, count > 0)
        assert y["age"][k] == t - (newest or 0.0)
        if newest is not None:
            for name in MOTION:
                assert y[name][k] == pytest.approx(sent(newest)[f"message.{name}"], rel=1e-15, abs=1e-15)
    assert count > 3


def test_latency_beyond_the_period_keeps_order(kernel: Kernel) -> None:
    """25 messages under way at once, the most there can be: all arrive, each half a second late."""
    y = received(kernel, {**CLEAN, "message_period": 0.02, "latency": 0.5}, 3.0)
    begun = y["t"] > 0.4999
    np.testing.assert_allclose(y["age"][begun], np.tile([0.5, 0.51], 125), atol=1e-9)
    np.testing.assert_array_equal(y["count"][begun], np.repeat(np.arange(1, 126), 2))
    assert not y["valid"][~begun].any()


def test_yaw_is_received_within_half_a_turn(kernel: Kernel) -> None:
    radio = Direct(COMPONENT, {**CLEAN, "latency": 0.0}, {"message.yaw": 5 * math.pi / 2}, kernel=kernel)
    radio.sample()
    assert radio["leader.yaw"] == pytest.approx(math.pi / 2)
    across = Direct(COMPONENT, {**CLEAN, "latency": 0.0, "yaw.noise": 0.1}, {"message.yaw": math.pi}, kernel=kernel)
    yaws = []
    for _ in range(300):
        across.sample()
        yaws.append(across["leader.yaw"])
    assert max(np.abs(yaws)) <= math.pi
    assert {-1.0, 1.0} == set(np.sign(yaws))


def test_noise_has_its_distribution_and_no_memory(kernel: Kernel) -> None:
    """Chi-square bounds of the variance, normality, and no correlation between messages or between signals."""
    errors = still(kernel, {"seed": 4}, 4000)
    sigma = np.array([0.01, 0.01, 0.001, 0.02, 0.02, 0.002])
    count = len(errors)
    low, high = stats.chi2.interval(1 - 1e-4, count)
    squares = np.sum((errors / sigma) ** 2, axis=0)
    assert (low < squares).all()
    assert (squares < high).all()
    assert (np.abs(errors.mean(axis=0)) < 4 * sigma / math.sqrt(count)).all()
    assert all(stats.kstest(column, "norm").pvalue > 1e-3 for column in (errors / sigma).T)
    limit = 4.5 / math.sqrt(count)
    assert np.abs(np.corrcoef(errors.T) - np.eye(6)).max() < limit
    for column in errors.T:
        assert abs(np.corrcoef(column[1:], column[:-1])[0, 1]) < limit


@pytest.mark.parametrize(("share", "seed"), [(0.01, 1), (0.3, 2), (0.9, 3)])
def test_losses_are_binomial_and_independent(kernel: Kernel, share: float, seed: int) -> None:
    count = 4000
    radio = Direct(
        COMPONENT,
        {"message_period": 0.02, "latency": 0.0, "loss.probability": share, "seed": seed, "sample_period": 0.02},
        kernel=kernel,
    )
    counts = [0.0]
    for _ in range(count):
        radio.sample(0.02)
        counts.append(radio["leader.count"])
    lost = np.diff(counts) == 0
    low, high = stats.binom.interval(1 - 1e-4, count, share)
    assert low <= lost.sum() <= high
    # of two losses in a row there are as many as of independent ones, within the spread of their number
    twice = np.sum(lost[1:] & lost[:-1])
    spread = math.sqrt(count * share**2 * (1 - share) * (1 + 3 * share))
    assert abs(twice - count * share**2) < 4.5 * max(spread, 1.0)


def test_a_lost_message_shows_as_age(kernel: Kernel) -> None:
    """Each message lost adds one period to the age at which the next comes in; nothing else changes."""
    y = received(kernel, {**CLEAN, "loss.probability": 0.4, "seed": 11}, 20.0)
    arrivals = np.flatnonzero(np.diff(y["count"]) > 0) + 1
    np.testing.assert_allclose(y["age"][arrivals], 0.02, atol=1e-9)
    gaps = np.diff(y["t"][arrivals]) / 0.1
    np.testing.assert_allclose(gaps, np.rint(gaps), atol=1e-6)
    assert gaps.max() > 2.5
    before = y["age"][arrivals[1:] - 1]
    np.testing.assert_allclose(before, 0.1 * gaps + 0.01, atol=1e-9)


def test_outage_holds_the_last_message(kernel: Kernel) -> None:
    """Sent from 1.00 to 1.95 s: ten messages lost; the one of 0.9 s is held until that of 2.0 s comes in."""
    y = received(kernel, {**CLEAN, "outage.start": 1.0, "outage.duration": 0.95}, 3.0)
    held = (y["t"] > 0.9199) & (y["t"] < 2.0199)
    assert np.ptp(y["count"][held]) == 0
    np.testing.assert_allclose(y["age"][held], y["t"][held] - 0.9, atol=1e-9)
    assert y["age"].max() == pytest.approx(1.11)
    for name in MOTION:
        assert np.ptp(y[name][held]) == 0
    assert y["valid"][held].all()
    assert y["count"][-1] == 20


@pytest.mark.parametrize("never", [{"loss.probability": 1.0}, {"outage.duration": 1e9}])
def test_no_message_ever(kernel: Kernel, never: Values) -> None:
    y = received(kernel, {**CLEAN, **never}, 30.0)
    np.testing.assert_array_equal(y["age"], y["t"])
    for name in (*MOTION, "count", "valid"):
        assert not y[name].any()


def test_same_seed_same_bits_and_other_seed_other_errors(kernel: Kernel) -> None:
    one, again, other = (still(kernel, {"seed": seed}, 200) for seed in (7, 7, 8))
    np.testing.assert_array_equal(one, again)
    assert not np.isclose(one, other).any()
    assert np.abs([np.corrcoef(a, b)[0, 1] for a, b in zip(one.T, other.T, strict=True)]).max() < 0.3


def test_noise_does_not_depend_on_what_is_lost(kernel: Kernel) -> None:
    """The errors of a message are drawn with it, so that runs with other losses can be compared."""
    full = received(kernel, {"seed": 5, "loss.probability": 0.0}, 10.0)
    some = received(kernel, {"seed": 5, "loss.probability": 0.5}, 10.0)
    same = np.isclose(full["age"], some["age"])
    assert 0.3 < np.mean(same) < 0.8
    for name in MOTION:
        np.testing.assert_array_equal(full[name][same], some[name][same])


def test_fewer_messages_than_samples_is_what_the_period_says(kernel: Kernel) -> None:
    for period in (0.02, 0.05, 0.37, 2.0):
        y = received(kernel, {**CLEAN, "message_period": period, "latency": 0.0}, 10.0)
        arrivals = y["t"][np.flatnonzero(np.diff(y["count"], prepend=0) > 0)]
        expected = [math.ceil(k * period / GRID - 1e-6) * GRID for k in range(len(arrivals))]
        np.testing.assert_allclose(arrivals, expected, atol=1e-9)
        assert all(later > earlier for earlier, later in pairwise(arrivals))
