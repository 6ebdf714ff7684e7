"""The manoeuvre as a trajectory: shapes, closed forms, what the road and the obstacle allow, and how it is played."""

from __future__ import annotations

import math
from functools import cache

import numpy as np
import pytest

from fmukit.direct import Direct
from fmus.cars.published import single_track
from fmus.controllers.reference import COMPONENT
from fmus.planner.errors import PlanningError
from fmus.planner.evasion import manoeuvre as module
from fmus.planner.evasion.car import evading_car, input_limits
from fmus.planner.evasion.lane_change import lane_change, road
from fmus.planner.evasion.manoeuvre import Manoeuvre, manoeuvre, stop
from fmus.planner.evasion.situation import Encounter, Surroundings

ROAD = Surroundings()
BRAKE, STEER, BOTH, NEITHER = (Encounter(25.0, distance) for distance in (50.0, 40.0, 35.3, 27.0))
ALL = (BRAKE, STEER, BOTH, NEITHER)


@cache
def planned(met: Encounter) -> Manoeuvre:
    return manoeuvre(met)


@pytest.mark.parametrize(("met", "code"), list(zip(ALL, range(4), strict=True)))
def test_every_action_begins_with_the_reaction(met: Encounter, code: int) -> None:
    found = planned(met)
    t, x, y, course, v, a, curvature = found.rows.T
    assert found.decision.code == code
    assert (np.diff(t) > 0).all() and len(t) <= 4000 and np.isfinite(found.rows).all()
    early = t < ROAD.reaction_time + ROAD.lead - 2e-3
    np.testing.assert_allclose(x[early], 25.0 * t[early])
    assert not y[early].any() and not course[early].any() and not a[early].any() and not curvature[early].any()
    assert (v[early] == 25.0).all()


@pytest.mark.parametrize("met", ALL)
def test_the_columns_belong_together(met: Encounter) -> None:
    """Position from speed and course, course from speed and curvature, speed from acceleration."""
    t, x, y, course, v, a, curvature = planned(met).rows.T
    for whole, rate in ((x, v * np.cos(course)), (y, v * np.sin(course)), (course, v * curvature), (v, a)):
        summed = np.concatenate([[0], np.cumsum(0.5 * (rate[1:] + rate[:-1]) * np.diff(t))])
        np.testing.assert_allclose(summed, whole - whole[0], atol=0.03)


def test_a_stop() -> None:
    t, x, y, course, v, a, _ = stop(20.0, 5.0, x=3.0, y=4.0, course=0.3).T
    along = 20 * t - 2.5 * t**2
    np.testing.assert_allclose(x, 3 + along * math.cos(0.3), atol=1e-12)
    np.testing.assert_allclose(y, 4 + along * math.sin(0.3), atol=1e-12)
    assert t[-1] == 4.0 and v[-1] == 0 == a[-1] and np.hypot(x[-1] - 3, y[-1] - 4) == pytest.approx(40)
    assert (course == 0.3).all() and (a[:-1] == -5).all()


def test_the_time_of_a_stop_increases_at_every_speed() -> None:
    for deceleration in (2.4, 4.8, 8.0):
        for speed in (*np.arange(5.0, 35.0, 0.004), 17.928, *(deceleration * (0.02 * np.arange(100, 180) + 1e-3))):
            t = stop(speed, deceleration)[:, 0]
            assert np.diff(t).min() > 1e-6 and np.diff(t).max() < 0.0221, speed
            assert t[0] == 0 and t[-1] == speed / deceleration


def test_a_stop_at_a_speed_that_once_gave_a_time_twice() -> None:
    assert (np.diff(manoeuvre(Encounter(17.928, 100.0)).rows[:, 0]) > 1e-6).all()


def test_rows_that_cannot_be_played_are_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    twice = np.repeat(stop(25.0, 8.0), 2, axis=0)
    monkeypatch.setattr(module, "stop", lambda *_: twice)
    with pytest.raises(PlanningError, match="finite ones whose time increases"):
        manoeuvre(BRAKE)


def test_braking_stops_short_of_the_obstacle() -> None:
    rows = planned(BRAKE).rows
    assert rows[-1, 4] == 0 and not rows[:, 2].any()
    assert rows[-1, 1] == pytest.approx(0.38 * 25 + 25**2 / 16) and rows[-1, 1] < BRAKE.distance


@pytest.mark.parametrize("met", [STEER, BOTH, Encounter(30.0, 64.4, friction=0.3), Encounter(16.0, 21.8, width=1.0)])
def test_the_lane_change_leaves_the_obstacle_and_the_road_alone(met: Encounter) -> None:
    found = planned(met)
    assert found.decision.action in ("steer", "brake and steer")
    _, x, y, course, v, _, _ = found.rows.T
    beside = x >= met.distance
    assert y[beside].min() > ROAD.offset(met.width) - 0.02, "the offset is not there when the nose reaches the obstacle"
    assert y.max() < ROAD.edge + 0.02 and y.min() > ROAD.right - 0.02
    assert y[-1] == pytest.approx(ROAD.lane, abs=1e-3) and abs(course[-1]) < 1e-3
    assert v.max() <= met.speed + 1e-6, "no motors"


def test_brakes() -> None:
    steer = lane_change(STEER, "steer", ROAD)
    both = lane_change(BOTH, "brake", ROAD)
    assert not steer.nodes.u[1:].any()
    assert -4001 < both.nodes.u[2].min() < -2000, "the rear axle brakes"
    assert both.nodes.u[1].min() > -6001 and both.nodes.u[1:].max() < 1
    assert both.nodes.x[2, -1] < steer.nodes.x[2, -1]
    for plan in (steer, both):
        assert plan.replay_error() < 0.01
        assert np.abs(plan.nodes.x[3]).max() < 0.121


def test_a_longer_way_is_gentler() -> None:
    peaks = []
    for distance in (36.0, 45.0):
        plan = lane_change(Encounter(25.0, distance), "steer", ROAD)
        rate = plan.vehicle.f.map(len(plan.nodes.T))(plan.nodes.x[:, :-1], plan.nodes.u).full()
        peaks.append(np.abs(25 * (rate[3] + rate[4])).max())
    assert peaks[1] < 0.8 * peaks[0]


def test_what_cannot_be_avoided_is_hit_slowly_and_off_centre() -> None:
    found = planned(NEITHER)
    t, x, y, course, v, a, _ = found.rows.T
    hit = int(np.argmax(x >= NEITHER.distance))
    assert v[hit] == pytest.approx(found.decision.impact, abs=0.6)
    assert v[hit] <= found.decision.impact, "steering costs no braking"
    assert y[hit] > 0.25 and abs(course[hit]) < 0.11
    assert a[(t > 0.39) & (v > 0)].max() < -7.9, "the brakes are released"
    assert v[-1] == 0 and y[-1] < ROAD.edge, "it stops on the road"


@pytest.mark.parametrize(
    "met", [Encounter(25.0, 5.0), Encounter(20.0, 30.6, width=7.0), Encounter(25.0, 41.0, width=7)]
)
def test_when_steering_is_worth_nothing_the_car_only_brakes(met: Encounter) -> None:
    found = planned(met)
    assert found.decision.action == "mitigate"
    assert not found.rows[:, 2].any() and found.rows[-1, 4] == 0


@pytest.mark.nightly
def test_a_plan_beyond_the_last_point_is_refused() -> None:
    with pytest.raises(PlanningError):
        lane_change(Encounter(25.0, 9.5 + 20.0), "steer", ROAD)


def test_a_car_takes_time_to_react() -> None:
    with pytest.raises(PlanningError, match="reaction time is 0 s"):
        manoeuvre(BRAKE, surroundings=Surroundings(reaction_time=0.0))


def test_the_road_rises_where_the_nose_reaches_the_obstacle() -> None:
    way = road(STEER, ROAD)
    gates = way.gates(75)
    x = gates.frames[:, 0]
    assert way.turn == 40.0 - 9.5 and way.turn in x
    np.testing.assert_array_equal(gates.low, np.where(x >= way.turn, ROAD.offset(2.0), ROAD.right))
    assert way.violation(np.array([[10.0, 0.0], [40.0, ROAD.offset(2.0)]])) == 0
    assert way.violation(np.array([[10.0, 0.0], [40.0, 0.0]])) == pytest.approx(ROAD.offset(2.0))
    assert way.violation(np.array([[10.0, 9.0]])) == pytest.approx(9 - ROAD.edge)


def test_forces_are_in_proportion_to_the_friction() -> None:
    least, most = input_limits(0.5, "drive")
    assert least.tolist() == [-0.5, -3000, -2000] and most.tolist() == [0.5, 0, 2500]
    assert all(bound[1:].tolist() == [0, 0] for bound in input_limits(0.5, "steer"))
    least, most = input_limits(1.0, "full brakes")
    assert least[1:].tolist() == most[1:].tolist() == [-6000, -4000]
    # at small slip angles the road does not matter: the stiffness keeps
    x, u = [0, 0, 20, 0.001, 0, 0, 0], [0, 0, 0]
    slopes = [evading_car(single_track(), mu, "steer").f(x, u).full()[3, 0] for mu in (0.3, 1.0)]
    assert slopes[0] == pytest.approx(slopes[1], rel=2e-3)


@pytest.mark.parametrize("met", ALL)
def test_reference_trajectory_plays_it(met: Encounter) -> None:
    rows = planned(met).rows
    player = Direct(COMPONENT, table=rows)
    for _ in range(150):
        player.sample(0.02)
        t = (player.samples - 1) * 0.02
        expected = [np.interp(t, rows[:, 0], rows[:, k]) for k in (1, 2, 3, 4)]
        seen = [player[f"reference.{name}"] for name in ("x", "y", "course", "speed")]
        assert seen == pytest.approx(expected, abs=5e-3)
