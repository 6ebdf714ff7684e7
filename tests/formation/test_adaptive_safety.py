"""AdaptiveFollower where things go wrong: its leader stops, reverses, falls silent, or is nowhere near."""

from __future__ import annotations

import numpy as np
import pytest
from adaptive_loop import KERNEL, Run, T, pose, simulate

from fmukit.direct import Direct
from fmus.controllers.adaptive_follower import COMPONENT

LIMITS = {"command.speed": (8.0, 4.0), "command.yaw_rate": (3.0, 3.0)}
"""Fastest fall and rise of the commands per second: start values of limit.*."""
LAG = 0.2


def assert_sane(run: Run) -> None:
    """Finite outputs, no command beyond its limits, none that jumps."""
    for name, values in run.outputs.items():
        assert np.isfinite(values).all(), name
    for name, (fall, rise) in LIMITS.items():
        steps = np.diff(run.outputs[name]) / T
        assert -fall - 1e-6 <= steps.min(), name
        assert steps.max() <= rise + 1e-6, name
    assert run.outputs["command.speed"].min() >= 0.0
    assert run.outputs["command.speed"].max() <= 45.0
    grip = run.outputs["command.yaw_rate"] * np.minimum(run.outputs["command.speed"], 45.0)
    assert np.abs(grip).max() < 1.2 * 0.7 * 9.81


def test_a_leader_that_stops_is_waited_for_and_followed_again():
    def stop_and_go(t):
        return float(np.interp(t, [2, 7, 20, 30], [20, 0, 0, 15]))

    run = simulate(speed=stop_and_go, yaw_rate=lambda t: 0.0, lag=LAG, duration=50.0)
    assert_sane(run)
    standing = (run.time > 17) & (run.time < 20)
    assert run.outputs["command.speed"][standing].max() < 0.1
    assert np.abs(run.outputs["command.yaw_rate"][standing]).max() < 0.01
    assert run.rms(after=45.0) < 0.3


def test_a_leader_that_reverses_finds_its_follower_standing():
    """It backs up past the follower's place; the follower neither follows it nor spins."""

    def back_up(t):
        return float(np.interp(t, [2, 6, 8, 9], [10, 0, 0, -3]))

    run = simulate(speed=back_up, yaw_rate=lambda t: 0.1 if t > 9 else 0.0, lag=LAG, duration=30.0)
    assert_sane(run)
    standing = run.time > 15
    assert run.outputs["command.speed"][standing].max() < 1e-3
    assert np.abs(run.outputs["command.yaw_rate"][standing]).max() < 1e-3
    assert run.outputs["weights.norm"].max() < 30.0


@pytest.mark.parametrize("how", ["old", "invalid"])
def test_a_lost_leader_then_a_stop_then_on_again(how):
    """Silent from 5 s to 16 s: on at 20 m/s for 2 s, then 2 m/s2 down; weights rest; the place is found again."""
    gap, patience, last = (5.0, 16.0), 0.5, {}

    def hear(k, leader):
        t = k * T
        if not gap[0] <= t < gap[1]:
            last.update(pose(leader))
            return {**last, "leader.age": 0.0, "leader.valid": 1.0}
        return {**last, "leader.age": t - gap[0] + T, "leader.valid": 1.0 if how == "old" else 0.0}

    run = simulate(speed=lambda t: 20.0, yaw_rate=lambda t: 0.0, lag=LAG, duration=75.0, hear=hear)
    assert_sane(run)
    begin = gap[0] + (patience if how == "old" else 0.0)
    lost = run.outputs["link.lost"] > 0.5
    assert run.time[lost][0] == pytest.approx(begin, abs=0.03)
    assert run.time[lost][-1] == pytest.approx(gap[1], abs=0.03)
    on = lost & (run.time < begin + 1.9)
    assert np.abs(run.outputs["command.speed"][on] - 20.0).max() < 0.3
    braking = lost & (run.time > begin + 2.1) & (run.time < begin + 8.0)
    np.testing.assert_allclose(run.outputs["command.acceleration"][braking], -2.0, atol=1e-6)
    assert np.ptp(run.outputs["weights.norm"][lost]) < 1e-9
    assert np.abs(run.outputs["command.yaw_rate"][lost][20:]).max() == 0.0
    assert run.rms(after=70.0) < 0.3


def test_a_leader_never_heard_is_waited_for():
    """On at the own speed for 2 s, then to a stop, straight."""

    def silence(k, leader):
        return {"leader.valid": 0.0, "leader.age": k * T}

    run = simulate(speed=lambda t: 12.0, yaw_rate=lambda t: 0.0, lag=LAG, duration=12.0, hear=silence)
    assert_sane(run)
    assert run.outputs["link.lost"].all()
    assert run.outputs["command.speed"][run.time < 1.9].min() > 11.9
    assert run.outputs["command.speed"][-1] == 0.0
    assert not run.outputs["command.yaw_rate"].any()


@pytest.mark.parametrize("r", [(0.0, 0.0), (1e4, 0.0), (-1e4, 0.0), (0.0, 1e4), (1e5, -1e5)])
def test_absurd_places_are_made_for_within_the_limits(r):
    """Also the leader's own place. The follower is led off towards the place, as slowly as its limits need."""

    def send(t):
        return {"formation.x": r[0] if t > 1 else -12.0, "formation.y": r[1] if t > 1 else 0.0}

    run = simulate(speed=lambda t: 20.0, yaw_rate=lambda t: 0.05, r=(-12.0, 0.0), lag=LAG, duration=25.0, inputs=send)
    assert_sane(run)
    assert run.outputs["weights.norm"].max() < 40.0
    gone = np.array([run.outputs[f"offset.{axis}"][-1] for axis in "xy"]) - (-12.0, 0.0)
    way = np.array(r) - (-12.0, 0.0)
    if r == (0.0, 0.0):
        np.testing.assert_allclose(gone, way, atol=1e-9)
        assert run.rms(after=20.0) < 0.3
    else:
        assert 0.0 < gone @ way / (way @ way) < 0.1


def test_a_jumping_leader_does_not_make_the_commands_jump():
    """Its receiver hops by 50 m and by half a turn, back and forth."""

    def hop(k, leader):
        place = pose(leader)
        if (k // 100) % 2:
            place["leader.position.y"] += 50.0
            place["leader.yaw"] += np.pi
        return place

    run = simulate(speed=lambda t: 20.0, yaw_rate=lambda t: 0.0, lag=LAG, duration=20.0, hear=hop)
    assert_sane(run)
    assert run.outputs["weights.norm"].max() < 60.0


def test_yaw_angles_may_be_wrapped():
    """Round a circle: the leader's yaw in (-pi, pi], the own one continuous, give what continuous ones give."""

    def wrapped(k, leader):
        return {**pose(leader), "leader.yaw": float(np.angle(np.exp(1j * leader.yaw)))}

    same = {"speed": lambda t: 20.0, "yaw_rate": lambda t: 0.3, "lag": LAG, "duration": 25.0}
    plain, other = simulate(**same), simulate(**same, hear=wrapped)
    np.testing.assert_allclose(other.outputs["command.yaw_rate"], plain.outputs["command.yaw_rate"], atol=1e-9)
    np.testing.assert_allclose(other.z, plain.z, atol=1e-7)


@pytest.mark.parametrize("seed", range(4))
def test_nothing_that_can_be_heard_makes_nan(seed):
    """Inputs of any size up to 1e9, messages come and go, gains anywhere in their ranges."""
    rng = np.random.default_rng(seed)
    reals = [v for v in COMPONENT.interface.select("parameter") if v.type == "Real" and not v.name.startswith("design")]
    factors = 10 ** rng.uniform(-2, 2, len(reals))
    parameters = {
        v.name: float(np.clip(v.start * f, v.minimum, v.maximum)) for v, f in zip(reals, factors, strict=True)
    }
    follower = Direct(COMPONENT, {**parameters, "sample_period": 0.02}, kernel=KERNEL)
    names = follower.interface.names("input")
    for size in 10.0 ** np.arange(-1, 10):
        for _ in range(20):
            heard = {"leader.age": abs(rng.normal()), "leader.valid": float(rng.random() > 0.1)}
            heard["feedforward.valid"] = float(rng.random() > 0.5)
            place = {f"formation.{axis}": np.clip(size * rng.normal(), -1e5, 1e5) for axis in "xy"}
            follower.set({**dict(zip(names, size * rng.normal(size=len(names)), strict=True)), **heard, **place})
            follower.sample()
            assert np.isfinite(follower.y).all()
            assert np.isfinite(follower.x).all()
            assert 0.0 <= follower["command.speed"] <= parameters["limit.speed"]
