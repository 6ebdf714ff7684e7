"""How long the hand of an adaptive follower has to be: what the sideslip of a steady turn takes from turning."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import brentq

from fmukit.direct import Direct
from fmus.controllers.adaptive_follower import COMPONENT

FOLLOWER = Direct(COMPONENT)
START = dict(zip(FOLLOWER.interface.names("parameter"), FOLLOWER.p, strict=True))


def across_per_yaw_rate(v: float, a: float) -> float:
    """(v_y + a omega)/omega [m] of the linear single-track car in a steady turn at v, from its two balances."""
    m, C_F, C_R, t = (START[f"design.{n}"] for n in ("mass", "cornering_front", "cornering_rear", "pneumatic_trail"))
    l_F, l_R = START["design.l_f"] - t, START["design.l_r"] + t
    front, rear = C_F * np.array([-1 / v, 1.0]), C_R * np.array([-1 / v, 0.0])  # per v_y and steering angle
    at_one = m * v + C_F * l_F / v - C_R * l_R / v, C_F * l_F**2 / v + C_R * l_R**2 / v  # what omega = 1 rad/s asks for
    v_y, _ = np.linalg.solve(np.array([front + rear, l_F * front - l_R * rear]), at_one)
    return float(v_y + a)


@pytest.mark.parametrize(("v", "shortest"), [(25.0, 3.9), (30.0, 6.2), (45.0, 15.9), (33.2, 8.0)])
def test_figures_of_the_readme(v: float, shortest: float) -> None:
    assert -across_per_yaw_rate(v, 0.0) == pytest.approx(shortest, abs=0.05)


def test_the_start_value_is_long_enough_up_to_the_speed_it_is_told_for() -> None:
    a = START["hand.distance"]
    fastest = brentq(lambda v: across_per_yaw_rate(v, a), 10.0, 60.0)
    assert fastest == pytest.approx(29.6, abs=0.1)
    (port,) = [v for v in FOLLOWER.interface.select("parameter") if v.name == "hand.distance"]
    assert f"{fastest:.1f} m/s" in port.source
