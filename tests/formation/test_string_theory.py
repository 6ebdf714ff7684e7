"""String stability of the linear law on points: closed forms against frequencies and simulation, and what remedies do.

Error of the leader's motion in front of a follower with u = -K z - K_i int z:  T = (K s + K_i)/(s^2 + K s + K_i).
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pytest
from chain_model import Law, largest, simulate, transfer
from head_motion import OMEGA, SETTLE, braking, swept

from cosim.scenario.metric import Metric
from scenarios.formation.string_stability import gain_metrics, gains, ratio, ratio_metrics, speed_ratio_metrics
from scenarios.platoon import excitation
from scenarios.platoon.excitation import LINES, PERIOD, multisine, straight

FOLLOWERS = 4
STEP = 0.02


def sweep(law: Law, star: bool = False):
    """The last whole period of a drive whose head is excited; every 20 ms."""
    drive = simulate(law, swept(0.5), FOLLOWERS, SETTLE + PERIOD, star, STEP)
    late = drive.time >= SETTLE - 1e-9
    return drive.errors[late], drive.speeds[late]


def values(metrics: Mapping[str, Metric]) -> dict[str, float]:
    return {name: metric.value for name, metric in metrics.items()}


def by_car(columns: np.ndarray, first: int) -> dict[int, np.ndarray]:
    return {first + i: columns[:, i] for i in range(columns.shape[1])}


@pytest.mark.parametrize(("part", "expected"), [(1 / 2, 1.272), (1 / 4, 1.1547), (1 / 8, 1.086), (1 / 32, 1.025)])
def test_the_law_amplifies_whatever_its_gains(part: float, expected: float) -> None:
    """K_i = part K^2 has damping 1/(2 sqrt(part)); the loop of type 2 amplifies always, and K only scales the time."""
    for gain in (1.0, 2.0, 4.0):
        assert largest(Law(gain, part * gain**2)) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("part", [1 / 2, 1 / 4, 1 / 8])
def test_the_amplification_in_closed_form(part: float) -> None:
    """|T|^2 with x = omega^2/K_i, c = K^2/K_i is (c x + 1)/((1 - x)^2 + c x), largest at x = (sqrt(1 + 2 c) - 1)/c."""
    c = 1 / part
    x = (math.sqrt(1 + 2 * c) - 1) / c
    assert largest(Law(2.0, 4 * part)) ** 2 == pytest.approx((c * x + 1) / ((1 - x) ** 2 + c * x), rel=1e-6)


@pytest.mark.parametrize("law", [Law(), Law(2.0, 0.5), Law(headway=1.0), Law(headway=1.0, lag=0.2), Law(lag=0.15)])
def test_the_gain_measured_in_a_sweep_is_that_of_the_transfer_function(law: Law) -> None:
    """Independent proof of the metric: followers simulated in time against the closed form at every line."""
    errors, speeds = sweep(law)
    exact = np.abs(transfer(law, OMEGA))
    for k in range(1, FOLLOWERS):
        np.testing.assert_allclose(gains(errors[:, k], errors[:, k - 1], LINES, 1), exact, rtol=2e-3)
    for k in range(FOLLOWERS):
        np.testing.assert_allclose(gains(speeds[:, k + 1], speeds[:, k], LINES, 1), exact, rtol=2e-3)
    found = values(gain_metrics(by_car(errors, 2), by_car(speeds, 1), LINES, 1))
    assert found["car3.error_gain_max"] == pytest.approx(exact.max(), rel=2e-3)
    assert found["car2.string_gain_max"] == pytest.approx(exact.max(), rel=2e-3)
    assert "car2.error_gain_max" not in found


def test_lines_in_noise_do_not_count() -> None:
    rng = np.random.default_rng(0)
    time = STEP * np.arange(round(PERIOD / STEP))
    ahead = sum(a * np.sin(w * time) for a, w in zip([1e-1] * 9 + [1e-4], OMEGA, strict=True))
    noise = 0.02 * rng.standard_normal((2, len(time)))
    found = gains(1.2 * ahead + noise[0], ahead + noise[1], LINES, 1)
    np.testing.assert_allclose(found[:-1], 1.2, rtol=0.05)
    assert math.isnan(found[-1])
    assert np.isnan(gains(noise[0], noise[1], LINES, 1)).sum() >= len(LINES) - 1


def test_ratios() -> None:
    time = STEP * np.arange(1000)
    z = {2: np.column_stack((0.5 * np.sin(time), 0.2 + 0 * time))}
    z |= {3: 1.5 * z[2], 4: 0.01 * z[2], 5: z[2]}
    found = values(ratio_metrics(z))
    assert found["car3.string_ratio_max"] == pytest.approx(1.5)
    assert found["car3.string_ratio_rms"] == pytest.approx(1.5)
    assert found["car4.string_ratio_norm_rms"] == pytest.approx(0.01 / 1.5)
    assert found["car5.string_ratio_max"] == pytest.approx(0.5 / 0.2, rel=1e-3)  # at least, car 4 being in its place
    assert found["string_ratio_max"] == found["car5.string_ratio_max"]
    for few in ({}, {2: z[2]}):
        assert ratio_metrics(few).keys() == {name for name in found if "." not in name}
        assert all(math.isnan(value) for value in values(ratio_metrics(few)).values())
    assert math.isnan(ratio(z[2][:0, 0], z[2][:0, 0])[0])


def test_an_error_that_grows_out_of_noise_has_a_ratio() -> None:
    """0.19 m ahead of 1 m is at least a fivefold growth; what stays below the floor has none."""
    z = {k: np.full((100, 2), size) for k, size in ((2, 0.1), (3, 0.19), (4, 1.0), (5, 1.0))}
    found = values(ratio_metrics(z))
    assert math.isnan(found["car3.string_ratio_max"])
    assert (found["car4.string_ratio_max"], found["car4.string_ratio_rms"]) == pytest.approx((5.0, 5.0))
    assert found["string_ratio_max"] == pytest.approx(5.0)


def test_speeds_are_compared_from_the_second_car_on() -> None:
    deviation = -15.0 * np.sin(np.linspace(0, np.pi, 200))
    found = values(speed_ratio_metrics({1: deviation, 2: 1.2 * deviation, 3: 0.6 * deviation}))
    assert (found["car2.speed_ratio_max"], found["car3.speed_ratio_rms"]) == pytest.approx((1.2, 0.5))
    assert found["speed_ratio_rms"] == pytest.approx(1.2)
    assert all(math.isnan(value) for value in values(speed_ratio_metrics({1: deviation})).values())
    assert len(speed_ratio_metrics({})) == 2


@pytest.mark.parametrize("integral", [0.5, 1.0, 2.0])
@pytest.mark.parametrize("lag", [0.0, 0.1, 0.2, 0.3])
@pytest.mark.parametrize("delay", [0.0, 0.02, 0.12])
def test_a_time_headway_of_sqrt_2_by_Ki_is_the_limit_whatever_lag_and_delay(
    integral: float, lag: float, delay: float
) -> None:
    """1/Gamma = e^(s delay) (1 + h s + s^2 (1 + lag s)/(K s + K_i)); its square is 1 + omega^2 (h^2 - 2/K_i) + ...

    so lag and delay move nothing at low frequency, where the limit is decided.
    """
    limit = math.sqrt(2 / integral)
    assert largest(Law(2.0, integral, 1.01 * limit, lag, delay)) <= 1.0 + 1e-9
    assert largest(Law(2.0, integral, 0.97 * limit, lag, delay)) > 1.0 + 1e-6


def test_amplification_by_five_percent_needs_little_more_than_half_of_that_headway() -> None:
    table = {
        lag: next(h for h in np.arange(0, 1.2, 0.01) if largest(Law(headway=h, lag=lag)) <= 1.05) for lag in (0, 0.2)
    }
    assert table == pytest.approx({0: 0.53, 0.2: 0.59})


def ratios(law: Law, star: bool = False, followers: int = 9) -> list[tuple[float, float]]:
    errors = simulate(law, braking, followers, 50.0, star, STEP).errors
    return [ratio(errors[:, k], errors[:, k - 1], 1e-6) for k in range(1, followers)]


def test_along_ten_cars_braking_grows_without_a_remedy_and_not_with_headway() -> None:
    assert min(min(pair) for pair in ratios(Law())[:3]) > 1.1
    errors = simulate(Law(), braking, 9, 50.0, False, STEP).errors
    assert np.abs(errors[:, -1]).max() > 2.5 * np.abs(errors[:, 0]).max()
    for lag in (0.0, 0.2):
        assert max(max(pair) for pair in ratios(Law(headway=1.0, lag=lag))) <= 1.0 + 1e-6


def test_in_a_star_all_have_the_same_error() -> None:
    assert ratios(Law(), star=True) == [pytest.approx((1.0, 1.0), abs=1e-9)] * 8


def test_the_heads_speed_takes_the_error_but_the_ratio_only_with_a_small_integral() -> None:
    """z_k = T z_{k-1} also with the head's speed: it is the error itself that becomes small, with the speed lag."""
    plain, known = (
        simulate(Law(lag=0.2, feedforward=on), braking, 9, 50.0, False, STEP).errors for on in (False, True)
    )
    assert np.abs(known[:, 0]).max() < 0.6 * np.abs(plain[:, 0]).max()
    lag = Law(lag=0.2)
    known_sweep = sweep(Law(lag=0.2, feedforward=True))[0]
    found = gains(known_sweep[:, 1], known_sweep[:, 0], LINES, 1)
    np.testing.assert_allclose(found, np.abs(transfer(lag, OMEGA)), rtol=5e-3)
    calm = ratios(Law(integral=2.0**2 / 64, lag=0.2, feedforward=True))
    assert max(max(pair) for pair in calm) <= 1.05


def test_the_heads_motion_is_consistent_and_as_strong_as_it_says() -> None:
    time = np.linspace(0.0, SETTLE + PERIOD, 80001)
    late = time >= SETTLE
    for speed, rate in (multisine(time, 0.5), excitation.braking(time - 8.0)):
        np.testing.assert_allclose(np.gradient(speed, time)[1:-1], rate[1:-1], atol=2e-4)
        rows = straight(time, 25.0 + speed, rate)
        np.testing.assert_allclose(np.gradient(rows[:, 1], time)[1:-1], 25.0 + speed[1:-1], atol=1e-5)
    _, rate = multisine(time, 0.5)
    assert np.sqrt(np.mean(rate[late][:-1] ** 2)) == pytest.approx(0.5, rel=1e-6)
    assert multisine(time[:1], 0.5)[0] == 0.0
    speed, rate = excitation.braking(time - 8.0)
    assert (speed.min(), speed[-1], rate.min(), rate.max()) == pytest.approx((-15.0, 0.0, -5.0, 2.5), abs=1e-9)
