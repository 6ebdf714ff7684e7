"""ConstraintFollower with constraints that contradict each other, leaders that are lost or reverse, absurd places."""

from __future__ import annotations

import constraint_loop as loop
import numpy as np
import pytest

from fmus.controllers.constraint_follower.interface import INTERFACE
from fmus.controllers.constraint_follower.model import kernel

STRAIGHT = loop.steady(20.0)
ON_PLACE = (-10.0, 0.0, 0.0, 20.0, 0.0)


ROD = {"constraint__offset": 0.0, "constraint__distance": 1.0}


@pytest.fixture(params=["prompt", "led"], autouse=True)
def _car(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Everything here holds for a car that does as told at once, and for one that lags and is led by as much."""
    if request.param == "led":
        led = {"lag": 0.1, "lead__speed": 0.1, "lead__yaw_rate": 0.1}
        plain = loop.run
        monkeypatch.setattr(loop, "run", lambda *args, **given: plain(*args, **(led | given)))


def _finite(r: loop.Run) -> bool:
    return bool(np.isfinite(list(r.outputs.values())).all())


def _peaceful(r: loop.Run) -> None:
    """Commands are finite, within their limits, and do not jump."""
    assert _finite(r)
    assert r["command.speed"].min() >= 0.0
    assert r["command.speed"].max() <= 45.0
    assert np.abs(r["command.yaw_rate"] * r.own[:, 3]).max() < 0.7 * 9.81 * 1.05
    assert np.diff(r["command.speed"]).max() <= 4.0 * loop.T + 1e-9
    assert np.diff(r["command.speed"]).min() >= -8.0 * loop.T - 1e-9
    assert np.abs(np.diff(r["command.yaw_rate"])).max() <= 3.0 * loop.T + 1e-9
    assert np.diff(r["command.speed"]) == pytest.approx(loop.T * r["command.acceleration"][1:], abs=1e-9)
    assert np.diff(r["command.yaw_rate"]) == pytest.approx(loop.T * r["command.yaw_acceleration"][1:], abs=1e-9)


@pytest.mark.parametrize("beside", [0.0, 1e-9, 1e-3, 0.5])
def test_distance_between_points_that_coincide(beside: float) -> None:
    """Exactly on one another there is no direction: nothing is asked for, the row is counted. Near by it is clear."""
    start = (0.0, beside, 0.0, 20.0, 0.0)
    r = loop.run(STRAIGHT, start, (-10.0, 0.0), 40.0, **ROD)
    _peaceful(r)
    assert r["constraint.deficiency"][0] == (1.0 if beside < 1e-2 else 0.0)
    if beside == 0.0:
        assert r["command.acceleration"][0] == pytest.approx(0.0, abs=1e-9)
    if beside >= 1e-3:
        apart = [np.hypot(*(loop.hand(own) - loop.hand(led))) for own, led in zip(r.own, r.leader, strict=True)]
        assert apart[-1] == pytest.approx(10.0, abs=0.05)


def test_a_distance_of_zero_is_a_place() -> None:
    r = loop.run(
        STRAIGHT, (-5.0, 1.0, 0.0, 20.0, 0.0), (0.0, 0.0), 60.0, constraint__offset=0.0, constraint__distance=1.0
    )
    _peaceful(r)
    assert np.hypot(*(loop.hand(r.own[-1]) - loop.hand(r.leader[-1]))) < 0.1


def test_distance_alone_is_kept_in_a_bend_wherever_the_follower_is() -> None:
    leader = loop.steady(20.0, 0.1)
    r = loop.run(
        leader, (-15.0, 3.0, 0.0, 20.0, 0.0), (-10.0, 0.0), 60.0, constraint__offset=0.0, constraint__distance=1.0
    )
    _peaceful(r)
    assert abs(r["violation.distance"][-1]) < 0.01
    assert np.abs(r.own[-200:, 3] - 20.0).max() < 1.0


def test_redundant_constraints_are_as_good_as_one() -> None:
    """Offset and distance agree: the same motion as with the offset alone, and one row is counted."""
    leader = loop.steady(20.0, 0.1)
    start = (-15.0, 3.0, 0.1, 20.0, 0.0)
    alone, both = (loop.run(leader, start, (-10.0, 4.0), 30.0, constraint__distance=on) for on in (0.0, 1.0))
    _peaceful(both)
    assert both["constraint.deficiency"].tolist() == [1.0] * 1500
    assert alone["constraint.deficiency"].tolist() == [0.0] * 1500
    assert both.errors()[-1] < 0.01
    assert both["constraint.residual"][-1] < 1e-3


def test_contradictory_constraints_give_a_compromise_that_is_told() -> None:
    """Behind a leader in a bend a car cannot be in its place and parallel: it is a little wrong in both."""
    leader = loop.steady(20.0, 0.1)
    start = (-15.0, 3.0, 0.1, 20.0, 0.0)
    r = loop.run(leader, start, (-10.0, 0.0), 40.0, constraint__heading=1.0)
    _peaceful(r)
    assert 0.1 < r.errors()[-1] < 0.5
    assert 0.1 < r["constraint.residual"][-1] < 1.0
    assert r["constraint.deficiency"][-1] == 1.0
    straight = loop.run(STRAIGHT, start, (-10.0, 0.0), 40.0, constraint__heading=1.0)
    assert straight.errors()[-1] < 1e-3
    assert straight["constraint.residual"][-1] < 1e-3


def test_two_places_at_once_are_met_halfway() -> None:
    def elsewhere(t: float) -> loop.Values:
        return {"reference.x": 20.0 * t, "reference.y": 4.0, "reference.speed": 20.0}

    r = loop.run(STRAIGHT, ON_PLACE, (-10.0, 0.0), 40.0, inputs=elsewhere, constraint__trajectory=1.0)
    _peaceful(r)
    assert r.own[-1, 0] - r.leader[-1, 0] == pytest.approx(-5.0, abs=0.01)
    assert r.own[-1, 1] == pytest.approx(2.0, abs=0.01)
    assert r["constraint.deficiency"][-1] == 2.0
    assert r["constraint.residual"][-1] == pytest.approx(np.hypot(10.0, 4.0) / np.sqrt(2.0), rel=0.3)


def test_without_any_constraint_the_follower_goes_on_and_says_so() -> None:
    r = loop.run(STRAIGHT, (-15.0, 3.0, 0.1, 18.0, 0.0), (-10.0, 0.0), 5.0, constraint__offset=0.0)
    _peaceful(r)
    assert r["constraint.none"].tolist() == [1.0] * 250
    assert r["command.speed"] == pytest.approx(18.0)
    assert not r["command.yaw_rate"].any()


@pytest.mark.parametrize("on", [0.0, 1.0])
def test_a_follower_without_constraints_is_advised_against_at_initialisation(on: float) -> None:
    """The FMU warns when the output that its advice names is 1 after initialisation."""
    follower = loop.follower(constraint__offset=on)
    y = kernel().initialise(follower.p, follower.u, [], [], 0)[2]
    (advice,) = INTERFACE.advice
    assert float(y[INTERFACE.names("output").index(advice.output)]) == 1.0 - on


def _there_and_back(t: float) -> float:
    if t < 10.0:
        return 15.0 if t < 3.0 else max(15.0 - 5.0 * (t - 3.0), 0.0)
    return max(-3.0 * (t - 10.0), -5.0) if t < 16.0 else min(-5.0 + 3.0 * (t - 16.0), 10.0)


@pytest.mark.parametrize("kind", ["offset", "distance"])
def test_a_leader_that_stops_and_reverses_is_waited_for(kind: str) -> None:
    leader = loop.along_x(_there_and_back, 50.0)
    switches = {"constraint__offset": float(kind == "offset"), "constraint__distance": float(kind == "distance")}
    r = loop.run(leader, (-10.0, 0.5, 0.0, 15.0, 0.0), (-10.0, 0.0), 45.0, radio=loop.Radio(leader, 1.0), **switches)
    _peaceful(r)
    stopped = (loop.T * np.arange(2250) > 9.0) & (loop.T * np.arange(2250) < 12.5)
    assert r["command.speed"][stopped].max() < 0.05
    assert np.ptp(r.own[stopped, 2]) < 0.02  # no spinning on the spot
    if kind == "offset":
        assert r["saturation.speed"][600] == 1.0
        assert r.errors()[-1] < 0.3


def test_lost_messages_lead_to_a_stop_straight_on_and_back() -> None:
    leader = loop.steady(20.0, 0.05)
    radio = loop.Radio(leader, 1.0, lambda t: 8.0 < t < 16.0)
    r = loop.run(leader, (-12.0, 0.0, 0.0, 20.0, 0.05), (-12.0, 0.0), 60.0, radio=radio)
    _peaceful(r)
    t = loop.T * np.arange(len(r.own))
    lost = (r["link.lost"] == 1.0) & (t > 0.01)
    assert t[lost][0] == pytest.approx(8.5, abs=0.15)
    assert t[lost][-1] == pytest.approx(16.02, abs=0.1)
    assert np.abs(r["command.yaw_rate"][(t > 8.8) & lost]).max() < 1e-12
    assert np.abs(np.diff(r["command.speed"][lost])).max() <= 2.0 * loop.T + 1e-9
    assert r["command.speed"][t < 10.0][-1] == pytest.approx(20.0, abs=0.3)
    assert r["command.speed"][lost][-1] < 11.0
    assert r.errors()[t < 8.0].max() < 0.2
    assert r.errors()[-1] < 0.2


def test_a_leader_whose_messages_hop_breaks_no_limit() -> None:
    """50 m and half a turn, there and back every 2 s: the grip is that of the speed driven and of the one to come."""
    leader = loop.steady(20.0)

    def hop(t: float) -> loop.Values:
        there = loop.message(leader(t))
        if int(t / 2.0) % 2:
            there = there | {"leader.position.y": 50.0, "leader.yaw": np.pi}
        return there

    r = loop.run(leader, (-10.0, 0.0, 0.0, 20.0, 0.0), (-10.0, 0.0), 30.0, radio=hop, lag=0.2)
    _peaceful(r)
    assert (r["saturation.speed"] == 1.0).any()


@pytest.mark.parametrize("turning", [1.0, -1.0])
def test_a_car_that_spins_is_not_told_to(turning: float) -> None:
    """Taken over at 1 rad/s and 20 m/s, three times the grip, the commands begin within it."""
    follower, own = loop.follower(), np.array([-10.0, 0.0, 0.0, 20.0, turning, 0.0])
    rows = [follower.step(loop.message(STRAIGHT(0.0)) | loop.estimate(own) | {"formation.x": -10.0}) for _ in range(50)]
    assert max(abs(y["command.yaw_rate"]) for y in rows) <= 0.7 * 9.81 / 20.0 + 1e-9
    assert rows[0]["saturation.yaw_rate"] == 1.0
    assert rows[0]["command.yaw_acceleration"] == pytest.approx(0.0, abs=0.1)  # grip falls with speed


def test_a_third_of_the_messages_lost_at_random_is_only_noise() -> None:
    leader, random = loop.s_curve(25.0, 0.14), np.random.default_rng(4)
    gone = random.uniform(size=1000) < 0.33
    radio = loop.Radio(leader, 1.0, lambda t: bool(gone[round(10.0 * t)]))
    r = loop.run(leader, (-12.0, 0.0, 0.0, 25.0, 0.0), (-12.0, 0.0), 60.0, radio=radio)
    _peaceful(r)
    assert r.errors()[500:].max() < 0.5
    assert np.sqrt(np.mean(r.errors()[500:] ** 2)) < 0.1


def test_before_the_first_message_the_follower_drives_on() -> None:
    silent = {"leader.valid": 0.0}
    r = loop.run(STRAIGHT, ON_PLACE, (-10.0, 0.0), 1.0, radio=lambda t: silent | {"leader.age": t})
    _peaceful(r)
    assert r["link.lost"].all()
    assert r["command.speed"] == pytest.approx(20.0)


@pytest.mark.parametrize("place", [(1e5, 0.0), (-1e5, 0.0), (0.0, 1e5), (-1e4, -1e4)])
@pytest.mark.parametrize("at_once", [True, False])
def test_absurd_places_are_approached_without_haste(place: tuple[float, float], at_once: bool) -> None:
    """At `transition.speed` or at limit.correction/K_d at most, within the limits, in the right direction."""
    r = loop.run(STRAIGHT, ON_PLACE, lambda t: place if at_once or t > 1.0 else (-10.0, 0.0), 30.0)
    _peaceful(r)
    relative = r.own[:, :2] - r.leader[:, :2]
    assert np.abs(r.own[:, 2]).max() < 0.5
    moved = relative[-1] - relative[0]
    assert moved @ np.array(place) > 0.0
    assert np.abs(np.diff(relative, axis=0)).max() < 10.5 * loop.T


def test_a_place_across_the_road_is_reached_in_its_own_time() -> None:
    r = loop.run(STRAIGHT, ON_PLACE, lambda t: (-10.0, 0.0) if t < 1.0 else (-40.0, 60.0), 40.0)
    _peaceful(r)
    assert r.errors()[-1] < 1e-3
    assert r.errors().max() < 0.2
    assert [r["offset.x"][-1], r["offset.y"][-1]] == [-40.0, 60.0]


def test_nothing_makes_it_forget_its_numbers() -> None:
    """Any input there can be: outputs stay finite and commands within their limits."""
    random = np.random.default_rng(0)
    on = dict.fromkeys(("constraint__distance", "constraint__heading", "constraint__trajectory"), 1.0)
    follower = loop.follower(headway=0.5, **on)
    names = [name for name in follower.names if name not in ("leader.age", "leader.valid")]
    for _ in range(3000):
        sizes = 10.0 ** random.uniform(-3.0, 6.0, len(names))
        inputs = dict(zip(names, sizes * random.normal(size=len(names)), strict=True))
        inputs |= {"formation.x": random.uniform(-1e5, 1e5), "formation.y": random.uniform(-1e5, 1e5)}
        inputs |= {"leader.age": random.choice([0.0, 0.05, 0.4, 3.0]), "leader.valid": random.choice([0.0, 1.0])}
        y = follower.step(inputs)
        assert np.isfinite(list(y.values())).all()
        assert 0.0 <= y["command.speed"] <= 45.0
