"""What theory says of growth from car to car: closed forms, and a linear chain simulated on its own."""

from __future__ import annotations

import numpy as np
import pytest
from chain_adaptive import Adaptive, transfer

from scenarios.formation import growth
from scenarios.formation.growth import AdaptiveLink, ConstraintLink

OMEGA = np.logspace(-2, 1.5, 400)


@pytest.mark.parametrize(("behind", "hand"), [(10.0, 4.0), (20.0, 4.0), (30.0, 15.0), (10.0, 8.0), (7.0, 8.0)])
@pytest.mark.parametrize("speed", [10.0, 30.0])
def test_a_lever_of_more_than_twice_the_hand_amplifies_at_every_frequency(
    behind: float, hand: float, speed: float
) -> None:
    """|P| of a place behind a hand, by frequency; its supremum does not depend on the speed."""
    s = 1j * np.logspace(-4, 5, 2000)
    P = np.abs((speed + (hand - behind) * s) / (speed + hand * s))
    assert growth.across(behind, hand) == pytest.approx(P.max(), rel=1e-6)
    assert (P[1:] > 1.0).all() == (behind > 2 * hand)


def simulated(link: ConstraintLink, omega: float) -> float:
    """Amplitude of a follower behind a leader x = sin(omega t): its law and filter as differential equations."""
    T, w_n, z = link.memory, link.omega_n, link.zeta
    h, stop = 1e-3, 40.0 + 4 * np.pi / omega
    v_hat = rate = curve = x = v = command = 0.0
    seen = []
    for k in range(int(stop / h)):
        t = k * h
        x_L, v_L = np.sin(omega * t), omega * np.cos(omega * t)
        new = v_L - v_hat
        v_hat, rate, curve = (
            v_hat + h * (rate + 3 / T * new),
            rate + h * (curve + 3 / T**2 * new),
            curve + h * new / T**3,
        )
        command += h * (rate + 2 * z * w_n * (v_L - v) + w_n**2 * (x_L - x))
        v += h * (command - v) / link.lag
        x += h * v
        seen.append(x)
    last = np.array(seen[-int(4 * np.pi / omega / h) :])
    return float(np.ptp(last) / 2)


@pytest.mark.parametrize("omega", [0.8, 2.0, 4.3])
def test_the_constraint_law_passes_on_what_its_equations_give_in_time(omega: float) -> None:
    link = ConstraintLink(0.1, 0.2, 0.0, 2.0, 1.0, 2.0)
    expected = abs(growth.transfer(link, np.array([omega]))[0])
    assert simulated(link, omega) == pytest.approx(expected, rel=0.02)


def test_filter_and_lag_each_amplify_and_together_more() -> None:
    """1.61 of the filter of 0.2 s, 1.31 of the lag of 0.1 s, 2.11 of both; 1 of exact rates and no lag."""
    factors = [
        growth.along(ConstraintLink(lag, memory, 0.0, 2.0, 1.0, 2.0))
        for lag, memory in ((0.0, 0.2), (0.1, 1e-9), (0.1, 0.2), (0.0, 1e-9))
    ]
    assert factors == pytest.approx([1.61, 1.31, 2.11, 1.0], abs=0.01)


@pytest.mark.parametrize("headway", [0.0, 0.5, 1.0])
def test_a_learning_follower_passes_on_what_its_linear_law_does(headway: float) -> None:
    """Against the transfer function written down for chains of such followers."""
    law = Adaptive(gain=3.0, output=9 / 7, headway=headway, lag=0.1)
    link = AdaptiveLink(0.1, 0.2, headway, 3.0, law.integral, law.reference_time, 0.0, heard=False)
    np.testing.assert_allclose(growth.transfer(link, OMEGA), transfer(law, OMEGA), rtol=1e-9)


def test_with_rates_that_are_heard_half_a_second_is_enough_and_nothing_is_not() -> None:
    def factor(headway: float, heard: bool) -> float:
        return growth.along(AdaptiveLink(0.1, 0.3, headway, 3.0, 4.5, 0.1, 0.11, heard))

    assert factor(0.5, True) == pytest.approx(1.0, abs=1e-3)
    assert factor(0.5, False) > 1.2
    assert factor(0.0, True) > factor(0.0, False) > 1.9
