"""The law on an ideal vehicle: poles of the constraint error, bends, transitions, ways to be told where to go."""

from __future__ import annotations

import casadi as ca
import constraint_loop as loop
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import curve_fit

from fmus.controllers.constraint_follower import places

PLACE = (-12.0, 3.0)


def _hand_acceleration(state: np.ndarray, y: loop.Values) -> np.ndarray:
    """h'' of a vehicle that does not slide, from p'' = v' e + v w n and the hand's centripetal and tangential terms."""
    _, _, yaw, v, w = state
    e, n = np.array([np.cos(yaw), np.sin(yaw)]), np.array([-np.sin(yaw), np.cos(yaw)])
    dv, dw = y["command.acceleration"], y["command.yaw_acceleration"]
    return dv * e + v * w * n + loop.A * (dw * n - w**2 * e)


def _wanted(leader: loop.Motion, t: float) -> np.ndarray:
    x, y, yaw, _, _ = leader(t)
    c, s = np.cos(yaw), np.sin(yaw)
    r = np.array([PLACE[0] + loop.A, PLACE[1]])
    return np.array([x, y]) + np.array([[c, -s], [s, c]]) @ r


def _answer(leader: loop.Motion, z: np.ndarray, omega_n: float, zeta: float) -> np.ndarray:
    """e'' at the constraint error (e, e') = z: the law's first answer, less the wanted point's own acceleration."""
    h, yaw = 1e-3, 0.3
    before, now, after = (_wanted(leader, k * h) for k in (-1, 0, 1))
    target_rate, target_acceleration = (after - before) / (2 * h), (after - 2 * now + before) / h**2
    rate = z[2:] + target_rate
    forward, across = np.array([[np.cos(yaw), np.sin(yaw)], [-np.sin(yaw), np.cos(yaw)]]) @ rate
    hand = z[:2] + now
    place = hand - loop.A * np.array([np.cos(yaw), np.sin(yaw)])
    state = np.array([*place, yaw, forward, across / loop.A])
    wide = {"limit__acceleration": 50.0, "limit__deceleration": 50.0, "limit__yaw_acceleration": 1e3}
    follower = loop.follower(omega_n=omega_n, zeta=zeta, limit__correction=100.0, limit__friction=5.0, **wide)
    inputs = loop.message(leader(0.0)) | loop.estimate(np.append(state, 0.0))
    y = follower.step(inputs | {"formation.x": PLACE[0], "formation.y": PLACE[1]})
    return _hand_acceleration(state, y) - target_acceleration


@pytest.mark.parametrize("rate", [0.0, 0.15])
@pytest.mark.parametrize(("omega_n", "zeta"), [(0.5, 1.0), (1.0, 1.0), (2.0, 1.0), (1.0, 0.7)])
def test_poles_of_the_constraint_error_are_those_designed(omega_n: float, zeta: float, rate: float) -> None:
    leader, step = loop.steady(20.0, rate), 1e-3
    columns = [
        (_answer(leader, d, omega_n, zeta) - _answer(leader, -d, omega_n, zeta)) / (2 * step) for d in step * np.eye(4)
    ]
    A = np.vstack([np.hstack([np.zeros((2, 2)), np.eye(2)]), np.array(columns).T])
    damping = omega_n * np.emath.sqrt(zeta**2 - 1.0)
    designed = np.repeat([-zeta * omega_n + damping, -zeta * omega_n - damping], 2)
    found = np.linalg.eigvals(A)
    nearest = np.abs(found[:, None] - designed[None, :]).min(axis=1)
    assert nearest.max() < 0.02 * omega_n
    assert found.real.sum() == pytest.approx(-4.0 * zeta * omega_n, rel=1e-4)


def test_at_rest_in_its_place_the_law_asks_for_the_wanted_points_acceleration() -> None:
    """In a bend of 3.6 m/s2 nothing is left over: the leader's centripetal acceleration is in the law."""
    leader = loop.steady(20.0, 0.18)
    assert np.abs(_answer(leader, np.zeros(4), 1.0, 1.0)).max() < 1e-5


def test_error_decays_with_a_double_pole_when_sampled() -> None:
    e = loop.run(loop.steady(), (-15.0, 0.5, 0.0, 20.0, 0.0), (-12.0, 0.0), 12.0).errors()
    t = loop.T * np.arange(len(e))
    (_, _, pole), _ = curve_fit(lambda t, a, b, s: (a + b * t) * np.exp(-s * t), t, e, p0=(3.0, 3.0, 1.0))
    assert pole == pytest.approx(1.0, rel=0.02)
    assert e == pytest.approx(e[0] * (1.0 + t) * np.exp(-t), abs=0.02)


@pytest.mark.parametrize("lag", [0.1, 0.2])
def test_a_lag_adds_its_pole_whatever_the_length_of_the_hand(lag: float) -> None:
    """tau s^3 + s^2 + 2 s + 1: integrated references in the drift keep speed and hand out of the error's equation."""
    poles = np.roots([lag, 1.0, 2.0, 1.0])
    r = loop.run(loop.steady(25.0), (-12.0, 1.0, 0.0, 25.0, 0.0), (-12.0, 0.0), 10.0, lag=lag)
    side = r.own[:, 1] + loop.A * np.sin(r.own[:, 2])
    t = loop.T * np.arange(len(side))
    weights = np.linalg.solve(np.vander(poles, 3, increasing=True).T, [1.0, 0.0, 0.0])
    assert side == pytest.approx((np.exp(np.outer(t, poles)) @ weights).real, abs=0.03)


@pytest.mark.parametrize("lag", [0.1, 0.2])
def test_a_known_lag_is_made_up_for(lag: float) -> None:
    leader, start = loop.s_curve(25.0, 0.14), (-12.0, 0.0, 0.0, 25.0, 0.0)
    plain, led = (
        loop.run(leader, start, (-12.0, 0.0), 30.0, lag=lag, lead__speed=lead, lead__yaw_rate=lead).errors()[300:]
        for lead in (0.0, lag)
    )
    assert plain.max() > 0.08
    assert led.max() < 0.02


@pytest.mark.parametrize("noise", [0.0, 1.0])
@pytest.mark.parametrize(("speed", "turn"), [(0.0, 0.0), (0.16, 0.06), (0.5, 0.5)])
def test_commands_are_consistent(speed: float, turn: float, noise: float) -> None:
    """Commands led by whatever time keep the limits, and the accelerations told are their rates."""
    leader, given = loop.s_curve(), {"lead__speed": speed, "lead__yaw_rate": turn}
    radio = loop.Radio(leader, noise)
    r = loop.run(leader, (-20.0, 2.0, 0.1, 18.0, 0.0), PLACE, 10.0, radio=radio, lag=0.15, **given)
    assert r["command.acceleration"].min() >= -8.0 - 1e-9
    assert r["command.acceleration"].max() <= 4.0 + 1e-9
    assert np.abs(r["command.yaw_acceleration"]).max() <= 3.0 + 1e-9
    assert np.diff(r["command.speed"]) == pytest.approx(loop.T * r["command.acceleration"][1:], abs=1e-9)
    assert np.diff(r["command.yaw_rate"]) == pytest.approx(loop.T * r["command.yaw_acceleration"][1:], abs=1e-9)


def test_limits_hold_and_the_integrals_do_not_run_away() -> None:
    """A car that does not answer: commands stay at most `windup.*` from what it does."""
    follower = loop.follower()
    stuck = loop.estimate(np.array([0.0, 0.0, 0.0, 10.0, 0.0, 0.0]))
    rows = []
    for k in range(300):
        ahead = loop.message((100.0 + 0.4 * k, 40.0, 0.0, 20.0, 0.0))
        rows.append(follower.step(ahead | stuck | {"formation.x": -10.0}))
    assert max(y["command.speed"] for y in rows) <= 13.0 + 4.0 * loop.T + 1e-9
    assert max(y["command.yaw_rate"] for y in rows) <= 0.4 + 3.0 * loop.T + 1e-9
    assert max(abs(y["command.acceleration"]) for y in rows) <= 4.0 + 1e-9
    assert rows[50]["saturation.speed"] == 1.0


def test_sideslip_counts_as_motion_of_the_hand() -> None:
    """A car that slides in step with its leader's motion is where it should be and asks for no correction."""
    slide = np.array([-12.0, 0.0, 0.1, 20.0 * np.cos(0.1), 0.0, -20.0 * np.sin(0.1)])
    slide[:2] += loop.A * (1.0 - np.cos(0.1)), -loop.A * np.sin(0.1)
    y = loop.follower().step(loop.message(loop.steady()(0.0)) | loop.estimate(slide) | {"formation.x": -12.0})
    assert [y["error.x"], y["error.y"]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert [y["command.acceleration"], y["command.yaw_acceleration"]] == pytest.approx([0.0, 0.0], abs=1e-9)


def _bus(leader: loop.Motion, t: float) -> loop.Values:
    x, y, course, v, w = leader(t)
    place = {"reference.x": x, "reference.y": y, "reference.course": course}
    return place | {"reference.speed": v, "reference.curvature": w / v}


@pytest.mark.parametrize("heard", [1.0, 0.0])
def test_the_head_of_a_formation_follows_its_trajectory_without_a_leader(heard: float) -> None:
    path = loop.s_curve(25.0, 0.14, 12.0)
    r = loop.run(
        loop.steady(0.0),
        (0.0, 2.0, 0.0, 25.0, 0.0),
        (0.0, 0.0),
        30.0,
        radio=lambda t: {"leader.valid": heard},
        inputs=lambda t: _bus(path, t),
        constraint__offset=0.0,
        constraint__trajectory=1.0,
    )
    away = np.array([np.hypot(*(own[:2] - path(k * loop.T)[:2])) for k, own in enumerate(r.own)])
    assert away[600:].max() < 0.01
    assert r["link.lost"].max() == 1.0 - heard


def test_on_a_trajectory_the_own_sideslip_is_allowed_for() -> None:
    """A car that must slide by 0.03 rad follows a straight with its O1, not with its hand."""
    beta, y = -0.03, loop.Values()
    follower = loop.follower(constraint__offset=0.0, constraint__trajectory=1.0)
    for k in range(500):
        state = np.array([0.4 * k, 0.0, -beta, 20.0 * np.cos(beta), 0.0, 20.0 * np.sin(beta)])
        y = follower.step(loop.estimate(state) | _bus(loop.steady(), k * loop.T))
    assert abs(y["error.y"]) < 2e-3
    assert abs(y["command.yaw_acceleration"]) < 2e-3


def test_headway_makes_the_distance_grow_with_the_speed() -> None:
    leader = loop.along_x(lambda t: 20.0 if t < 5.0 else min(20.0 + t - 5.0, 28.0), 50.0)
    r = loop.run(leader, (-26.0, 0.0, 0.0, 20.0, 0.0), (-10.0, 0.0), 45.0, headway=0.8)
    assert r.leader[-1, 0] - r.own[-1, 0] == pytest.approx(10.0 + 0.8 * 28.0, abs=0.01)
    assert r.errors().max() < 0.1
    assert np.diff(r.own[:, 3]).max() < 1.001 * loop.T
    assert r.own[:, 3].max() <= 28.001


@pytest.mark.parametrize(("period", "w"), [(0.02, 2.0), (0.06, 20.0), (1.0, 2.0), (1.0, 20.0)])
def test_the_headway_filter_is_exact_at_any_period(period: float, w: float) -> None:
    """A speed that grows by 0.7 m/s2 in one period, against scipy's integration of the double pole."""
    headway, v, dv, before = 0.8, 20.0, 0.7, np.array([15.0, 1.5])
    p = {name: ca.SX(value) for name, value in (("headway", headway), ("headway.filter", w), ("sample_period", period))}
    state = {"back": ca.SX(before[0]), "rate": ca.SX(before[1])}
    later = places.pulled_back(p, state, ca.SX(v), ca.SX(dv))
    after = np.array([float(ca.evalf(later[name])) for name in state])

    def rates(t: float, d: np.ndarray) -> list[float]:
        return [d[1], w**2 * (headway * (v + dv * t) - d[0]) - 2 * w * d[1]]

    paper = solve_ivp(rates, (0.0, period), before, rtol=1e-10, atol=1e-12).y[:, -1]
    assert after == pytest.approx(paper, rel=1e-7)
    held, yielding = (float(ca.evalf(part)) for part in places.acceleration(p, state, ca.SX(v)))
    assert held + yielding * dv == pytest.approx((paper[1] - before[1]) / period, rel=1e-6)


@pytest.mark.parametrize(("period", "w"), [(0.02, 2.0), (0.02, 20.0), (0.06, 20.0), (0.2, 4.0)])
def test_headway_is_calm_at_any_bandwidth_and_period(period: float, w: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The place falls back with v' itself: a loop of pole w (2 + headway w), closed within the sample."""
    monkeypatch.setattr(loop, "T", period)
    leader = loop.along_x(lambda t: 20.0 if t < 5.0 else min(20.0 + t - 5.0, 28.0), 50.0)
    given = {"headway": 1.0, "headway__filter": w, "sample_period": period}
    r = loop.run(leader, (-30.0, 0.0, 0.0, 20.0, 0.0), (-10.0, 0.0), 40.0, **given)
    assert r.leader[-1, 0] - r.own[-1, 0] == pytest.approx(38.0, abs=0.01)
    assert r["command.acceleration"].min() > -0.01
    assert r["command.acceleration"].max() < 1.01
