"""What a follower makes of its leader's messages: late, every 0.1 s, noisy."""

from __future__ import annotations

import itertools

import casadi as ca
import constraint_loop as loop
import numpy as np
import pytest

from fmus.controllers.formation import messages


def _accelerations(leader: loop.Motion, seconds: float, noise: float = 0.0, **p: float) -> np.ndarray:
    """(samples, 3): filtered v_x', v_y', omega' of the leader."""
    follower, radio, rows = loop.follower(**p), loop.Radio(leader, noise), []
    for k in range(round(seconds / loop.T)):
        y = follower.step(radio(k * loop.T) | loop.estimate(np.zeros(6)))
        rows.append([y["leader.acceleration.x"], y["leader.acceleration.y"], y["leader.yaw_acceleration"]])
    return np.array(rows)


def test_constant_and_steadily_growing_accelerations_are_found_without_lag() -> None:
    leader = loop.along_x(lambda t: 10.0 + 0.5 * t + 0.1 * t**2, 12.0)
    found = _accelerations(leader, 10.0)[:, 0]
    t = loop.T * np.arange(len(found))
    assert found[200:] == pytest.approx(0.5 + 0.2 * t[200:], abs=2e-3)


@pytest.mark.parametrize(("tau", "gain"), [(0.1, 10.0), (0.2, 4.18), (0.3, 2.38)])
def test_noise_of_the_acceleration_is_that_of_the_filter_on_paper(tau: float, gain: float) -> None:
    """Variance of the discounted least-squares parabola through white noise: its Lyapunov equation, iterated."""
    D, theta = 0.1, np.exp(-0.1 / tau)
    K = np.array([1 - theta**3, 1.5 * (1 - theta) ** 2 * (1 + theta) / D, (1 - theta) ** 3 / D**2])
    F = np.array([[1, D, D**2 / 2], [0, 1, D], [0, 0, 1]])
    A, P = (np.eye(3) - np.outer(K, [1, 0, 0])) @ F, np.zeros((3, 3))
    for _ in range(500):
        P = A @ P @ A.T + np.outer(K, K)
    assert np.sqrt(P[1, 1]) == pytest.approx(gain, rel=0.01)
    seen = _accelerations(loop.steady(20.0), 300.0, 1.0, leader__filter_time=tau)[501::5]  # as a message arrives
    for axis, sigma in ((0, 0.03), (2, 0.003)):
        assert seen[:, axis].std() == pytest.approx(gain * sigma, rel=0.12)


def test_a_swing_is_followed_but_for_a_tenth() -> None:
    leader = loop.along_x(lambda t: 20.0 + 2.0 * np.sin(t), 32.0)
    found = _accelerations(leader, 30.0)[:, 0]
    t = loop.T * np.arange(len(found))
    late = np.abs(found - 2.0 * np.cos(t))[500:].max() / 2.0
    assert 0.07 < late < 0.16  # 9 % at a message, and what changes until the next


@pytest.mark.parametrize("noise", [0.0, 1.0])
def test_bend_behind_a_radio(noise: float) -> None:
    """3.6 m/s2; held messages would be 2 m late, and a law without the leader's acceleration 3.6 m off."""
    leader = loop.steady(20.0, 0.18)
    r = loop.run(leader, (-12.0, 0.5, -0.5, 20.0, 0.18), (-12.0, 0.0), 30.0, radio=loop.Radio(leader, noise))
    e = r.errors()[750:]
    assert e.max() < (0.1 if noise else 0.01)
    assert np.sqrt(np.mean(e**2)) < (0.04 if noise else 0.005)


def test_between_messages_nothing_jumps() -> None:
    """With exact messages the commands do not tell when one comes."""
    leader = loop.s_curve(25.0, 0.14, 12.0)
    r = loop.run(leader, (-12.0, 0.0, 0.0, 25.0, 0.0), (-12.0, 0.0), 30.0, radio=loop.Radio(leader))
    assert np.abs(np.diff(r["command.acceleration"][500:])).max() < 0.03
    assert np.abs(np.diff(r["command.yaw_acceleration"][500:])).max() < 0.01
    assert r.errors()[500:].max() < 0.05


def test_yaw_angles_may_be_wrapped() -> None:
    """Round the circle twice, with the leader's angle in (-pi, pi]."""
    leader = loop.steady(20.0, 0.3)

    def wrapped(t: float) -> loop.Values:
        return loop.message(leader(t)) | {"leader.yaw": float(np.angle(np.exp(1j * leader(t)[2])))}

    r = loop.run(leader, (-8.0, 0.0, 0.0, 20.0, 0.3), (-8.0, 0.0), 45.0, radio=wrapped, constraint__heading=0.0)
    assert r.errors()[600:].max() < 0.02
    assert np.abs(r["command.acceleration"][600:]).max() < 0.05


@pytest.mark.parametrize("period", [1e-3, 5e-4])
def test_messages_at_every_sample_are_taken_however_short_the_period(
    period: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loop, "T", period)
    r = loop.run(loop.steady(20.0, 0.1), (-12.0, 0.0, 0.0, 20.0, 0.1), (-12.0, 0.0), 3.0, sample_period=period)
    assert r["leader.acceleration.x"] == pytest.approx(0.0, abs=1e-6)
    braking = loop.along_x(lambda t: 20.0 - t, 3.0)
    r = loop.run(braking, (-12.0, 0.0, 0.0, 20.0, 0.0), (-12.0, 0.0), 2.5, sample_period=period)
    assert r["leader.acceleration.x"][-1] == pytest.approx(-1.0, abs=0.01)
    assert r.errors()[-1] < 0.1


@pytest.mark.parametrize("period", [0.02, 1e-3, 5e-4])
def test_a_message_that_is_held_is_not_new(period: float) -> None:
    """Both followers ask the same function: sent 0.1 s apart each is new once, whatever the rounding of its age."""
    T, sent = ca.SX(period), np.floor(np.arange(round(1.0 / period)) * period / 0.1 + 1e-9) * 0.1
    age = np.arange(len(sent)) * period - sent
    before, now = ca.SX.sym("before"), ca.SX.sym("now")
    asked = ca.Function("news", [before, now], [*messages.news(ca.SX(1), before, now, T)])
    told = [tuple(map(float, asked(*pair))) for pair in itertools.pairwise(age)]
    assert [between for new, between in told if new] == pytest.approx([0.1] * 9)


@pytest.mark.parametrize("first", [0.03, 0.1, 1.0, 4.0])
def test_the_heads_broadcast_counts_from_its_first_message_on(first: float) -> None:
    """Until then feedforward.speed is a zero that nobody sent; leader and head speed up at 1 m/s2 all the time."""
    leader = loop.along_x(lambda t: 20.0 + t, 10.0)

    def broadcast(t: float) -> loop.Values:
        told = t >= first - 1e-9
        return {"feedforward.speed": leader(t)[3] if told else 0.0, "feedforward.valid": float(told)}

    place, start = (-12.0, 0.0), (-12.0, 0.0, 0.0, 20.0, 0.0)
    r = loop.run(leader, start, place, 8.0, inputs=broadcast, feedforward__enabled=1.0)
    t = loop.T * np.arange(len(r.own))
    assert r["leader.acceleration.x"].min() > -1e-9
    assert r["leader.acceleration.x"].max() < 1.8  # from 0 the filter, critically damped, overshoots by two thirds
    assert r["leader.acceleration.x"][-1] == pytest.approx(1.0, abs=0.02)
    if first > 2.0:
        assert r["leader.acceleration.x"][t > 2.0] == pytest.approx(1.0, abs=0.02)
    assert r.errors().max() < 0.3


def test_without_its_broadcast_the_leaders_own_messages_count() -> None:
    """Lost for good at 5 s: what follows is as if there had been none."""
    leader = loop.along_x(lambda t: 20.0 + np.sin(t), 15.0)
    place, start = (-12.0, 0.0), (-12.0, 0.0, 0.0, 20.0, 0.0)
    never, lost = (
        loop.run(
            leader,
            start,
            place,
            12.0,
            feedforward__enabled=1.0,
            inputs=lambda t, until=until: {"feedforward.speed": 30.0 - t, "feedforward.valid": float(t < until)},
        )
        for until in (0.0, 5.0)
    )
    assert lost["leader.acceleration.x"][100:250].max() < -0.9
    assert lost["leader.acceleration.x"][250:] == pytest.approx(never["leader.acceleration.x"][250:], abs=1e-12)
