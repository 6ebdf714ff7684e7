"""String stability of the adaptive law: its network along a chain against the linear law it is for small motions."""

from __future__ import annotations

import math

import numpy as np
import pytest
from chain_adaptive import Adaptive, simulate, transfer
from head_motion import OMEGA, SETTLE, braking, swept

from scenarios.formation.string_stability import gains, ratio
from scenarios.platoon.excitation import LINES, PERIOD
from scenarios.platoon.laws import GAIN, HEADWAY

FREQUENCIES = np.logspace(-3, 2, 20001)
FIRM = {"gain": GAIN, "output": GAIN**2 / 7, "hidden": GAIN**2 / 14}


@pytest.mark.parametrize("headway", [0.0, HEADWAY])
@pytest.mark.parametrize("acceleration", [0.02, 0.5])
def test_the_network_passes_a_sweep_on_as_the_linear_law_does(headway: float, acceleration: float) -> None:
    """The bias integrates with K_i = F sigma'(sigma - sigma' a) = 2.2/s2; the hidden weights hardly matter."""
    law = Adaptive(headway=headway, lag=0.1)
    drive = simulate(law, swept(acceleration), 3, SETTLE + PERIOD)
    late = drive.speeds[drive.time >= SETTLE - 1e-9]
    for k in range(3):
        found = gains(late[:, k + 1], late[:, k], LINES, 1)
        clear = np.isfinite(found)
        assert clear[:4].all()
        np.testing.assert_allclose(found[clear], np.abs(transfer(law, OMEGA))[clear], rtol=0.05, atol=0.01)


@pytest.mark.parametrize("lag", [0.0, 0.1, 0.2, 0.3])
@pytest.mark.parametrize("output", [0.15, 0.3, 0.57])
def test_the_headway_at_which_nothing_grows(lag: float, output: float) -> None:
    """h >= tau + sqrt(tau^2 + 2/K_i): the follower sees its commanded speed, which the car has only tau later.

    That is what slow motions need; at F = 0.57/s2 faster ones need up to 6 % more.
    """
    integral = Adaptive(output=output).integral
    limit = lag + math.sqrt(lag**2 + 2 / integral)
    for part, stable in ((1.07, True), (0.97, False)):
        largest = np.abs(transfer(Adaptive(output=output, lag=lag, headway=part * limit), FREQUENCIES)).max()
        assert (largest <= 1 + 1e-9) == stable


def test_the_headway_of_the_platoon_is_beyond_that() -> None:
    """With a lag of 0.1 or 0.2 s nothing grows; with 0.3 s little."""
    assert Adaptive(**FIRM).integral == pytest.approx(5.0, abs=0.1)
    for lag, bound in ((0.1, 1.0), (0.2, 1.0), (0.3, 1.03)):
        assert np.abs(transfer(Adaptive(**FIRM, lag=lag, headway=HEADWAY), FREQUENCIES)).max() <= bound + 1e-9


def test_braking_grows_along_ten_cars_without_headway_and_not_with_it() -> None:
    def ratios(headway: float, **law: float) -> list[float]:
        errors = simulate(Adaptive(headway=headway, **law), braking, 9, 50.0).errors
        return [value for k in range(1, 9) for value in ratio(errors[:, k], errors[:, k - 1], 1e-6)]

    assert min(ratios(0.0)) > 1.3
    assert max(ratios(HEADWAY, **FIRM)) <= 1.0
