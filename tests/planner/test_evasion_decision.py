"""The decision on a table made by hand, and encounters that cannot be."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from fmus.planner.errors import PlanningError
from fmus.planner.evasion.decision import ACTIONS, decide
from fmus.planner.evasion.situation import Encounter, Surroundings
from fmus.planner.evasion.table import LastPointTable, read

ROAD = Surroundings(reserve=1.1, reaction_time=0.4, lead=0.1, standstill_gap=0.75)
SPEEDS, OFFSETS, FRICTIONS = np.array([10.0, 20.0]), np.array([2.0, 3.0]), np.array([0.25, 1.0])


def table() -> LastPointTable:
    """Last point to steer (offset + speed)/2 + 2 at friction 1, twice that at 0.25; with brakes 2 m less."""
    rows = []
    for mu in FRICTIONS:
        for offset in OFFSETS:
            for v in SPEEDS:
                steer = (0.5 * (offset + v) + 2) / math.sqrt(mu)
                rows.append((mu, offset, v, 0.0, 0.0, steer, steer - 2))
    return LastPointTable(np.array(rows), FRICTIONS, OFFSETS, SPEEDS)


def at(left: float, **changes: float) -> str:
    """The action at 16 m/s when `left` [m] are left after the reaction; the obstacle asks for an offset of 2.5 m."""
    met = Encounter(16.0, left + 8.0, width=2 * (2.5 - 0.5) - 1.68)
    return decide(replace(met, **changes), table(), ROAD).action


def test_the_first_possible_action_is_taken() -> None:
    # braking 256/16 + 0.75 m; steering 1.1 (18.5/2 + 2) = 12.375 m; both 1.1 * 9.25 = 10.175 m
    below = 1e-6
    assert (at(16.75 + below), at(16.75 - below)) == ("brake", "steer")
    assert (at(12.375 + below), at(12.375 - below)) == ("steer", "brake and steer")
    assert (at(10.175 + below), at(10.175 - below)) == ("brake and steer", "mitigate")
    assert at(-5) == "mitigate"


def test_friction() -> None:
    # 0.25: braking 64.75 m, steering 1.1 * 22.5 = 24.75 m, both 1.1 * 20.5 = 22.55 m
    assert [at(left, friction=0.25) for left in (65, 30, 24, 20)] == list(ACTIONS)


def test_numbers_of_a_decision() -> None:
    decided = decide(Encounter(16.0, 18.0, width=2.32), table(), ROAD)
    assert (decided.code, decided.left) == (3, 10.0)
    assert (decided.brake, decided.steer, decided.brake_and_steer) == pytest.approx((16.75, 12.375, 10.175))
    assert decided.impact == pytest.approx(math.sqrt(256 - 160))
    assert decide(Encounter(16.0, 5.0, width=2.32), table(), ROAD).impact == 16.0
    assert decide(Encounter(16.0, 50.0, width=2.32), table(), ROAD).impact == 0.0


def test_an_obstacle_across_the_road_can_only_be_braked_for() -> None:
    assert at(15, width=7.0) == at(16.5, width=7.0) == "mitigate"
    assert decide(Encounter(16.0, 24.5, width=7.0), table(), ROAD).impact == 0, "it stops within the gap"
    assert at(17, width=7.0) == "brake"
    assert decide(Encounter(16.0, 20.0, width=7.0), table(), ROAD).steer == math.inf


def test_a_narrow_obstacle_is_passed_like_the_narrowest_of_the_table() -> None:
    ways = [decide(Encounter(16.0, 20.0, width=w), table(), ROAD).steer for w in (0.1, 0.5, 1.32)]
    assert ways == pytest.approx([1.1 * 11] * 3)


def test_closer_obstacles_never_make_it_easier() -> None:
    for mu in (0.3, 0.7, 1.0):
        for v in np.linspace(15, 35, 9):
            codes = [decide(Encounter(v, d, mu), read()).code for d in np.linspace(300, 0.1, 200)]
            assert codes == sorted(codes) and codes[-1] == 3


@pytest.mark.parametrize(
    ("met", "sentence"),
    [
        (Encounter(20.0, 0.0), "the distance of the obstacle is 0; give a positive finite number"),
        (Encounter(20.0, -3.0), "the distance of the obstacle is -3"),
        (Encounter(math.nan, 30.0), "the speed is nan"),
        (Encounter(20.0, math.inf), "the distance of the obstacle is inf"),
        (Encounter(20.0, 30.0, width=math.nan), "the width of the obstacle is nan"),
        (Encounter(20.0, 30.0, width=8.0), "the obstacle is 8 m wide, wider than the road of 7 m"),
        (Encounter(20.0, 30.0, friction=-1.0), "the friction is -1"),
        (Encounter(20.0, 30.0, length=0.0), "the length of the obstacle is 0"),
        (Encounter(40.0, 30.0), "the speed is 40 m/s; the table of last points holds 15 to 35 m/s"),
        (Encounter(40.0, 30.0, width=7.0), "the speed is 40 m/s"),
        (Encounter(20.0, 30.0, friction=0.1), "the friction is 0.1; the table of last points holds 0.3 to 1"),
    ],
)
def test_what_cannot_be_met(met: Encounter, sentence: str) -> None:
    with pytest.raises(PlanningError, match=sentence):
        decide(met, read())
