"""AdaptiveFollower behind a simulated leader: how well it keeps its place, and what its design choices are for."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from adaptive_loop import Message, Run, T, Unicycle, pose, simulate
from adaptive_network import INPUTS, NEURONS, OUTPUTS, sigma

from fmus.controllers.adaptive_follower import model

LAG = 0.2
SHORT_HAND = {"hand.distance": 2.5}
ZERO_WEIGHTS = {"bias.own_speed": 0}
UNLIMITED_RATES = {  # only speed and grip are limited
    **{"limit.acceleration": 50, "limit.deceleration": 50, "limit.curvature": 1e3, "limit.yaw_acceleration": 1e3},
    "realise.speed_time": 0,
}
RUSHING = {"catch_up.distance": 1e6}
"""However far it is from its place, a follower rushes there."""


def faster(t: float) -> float:
    """20 to 30 m/s within 20 s."""
    return 20.0 + 10.0 * min(max((t - 5.0) / 20.0, 0.0), 1.0)


def weave(t: float) -> float:
    return 0.12 * np.sin(0.5 * t)


def weights(run: Run) -> tuple[np.ndarray, np.ndarray]:
    states = model.STATES.split(ca.DM(run.follower.x))
    shapes = {"V": (INPUTS + 1, NEURONS), "W": (NEURONS + 1, OUTPUTS)}
    V, W = (np.array(states[name]).reshape(shape, order="F") for name, shape in shapes.items())
    return V, W


@pytest.mark.parametrize(
    ("delta", "hidden", "speed"), [(1e-3, 0.0, 20.0), (1e-2, 0.0, 30.0), (0.1, 0.0, 20.0), (0.1, 0.3, 20.0)]
)
def test_static_error_is_leak_times_speed_over_sigma_squared(delta, hidden, speed):
    """|e| = delta_w (1 + |e|^m) |Delta|/|sigma|^2 within 20 %; without the bracket where |e| is small."""
    learning = {"leak.output": delta, "adaptation.hidden": hidden}
    run = simulate(
        speed=lambda t: speed, yaw_rate=lambda t: 0.0, duration=40.0, parameters={**learning, **ZERO_WEIGHTS}
    )
    V, _ = weights(run)
    e = np.linalg.norm(run.z[-1])
    s = sigma(V, np.array([1, *np.tanh(run.z[-1] / 5), 0, 1, speed / 30, 0]))
    law = delta * speed / (s @ s)
    assert e == pytest.approx(law * (1 + e), rel=0.2)
    if e < 0.1:
        assert e == pytest.approx(law, rel=0.2)


def test_lagging_car_behind_a_weaving_leader_that_speeds_up():
    """Speed and yaw rate each answer with 0.2 s; 20 to 30 m/s, +-0.12 rad/s, r = (-12, 4) m, K = 2."""
    run = simulate(speed=faster, yaw_rate=weave, lag=LAG)
    assert run.rms() <= 0.25
    assert run.distance().max() <= 0.6
    assert not run.outputs["saturation.speed"].any()


def test_without_a_network_the_place_is_lost():
    """K z has to make up for the whole velocity of the leader: 20/2 to 30/2 m."""
    unlearnt = {"adaptation.output": 0, "adaptation.hidden": 0, **ZERO_WEIGHTS, **RUSHING}
    run = simulate(speed=faster, yaw_rate=weave, lag=LAG, parameters=unlearnt)
    assert 12.0 < run.rms() < 16.0


def in_the_followers_frame(lag: float, **parameters: float) -> Run:
    return simulate(speed=faster, yaw_rate=weave, lag=lag, parameters={"leader_frame": 0, **parameters})


def test_output_in_the_followers_frame_is_as_good_without_lag():
    assert in_the_followers_frame(0.0, **SHORT_HAND, **RUSHING).rms() <= 0.25


def test_output_in_the_followers_frame_swings_with_lag():
    """With all else at its start value it ends in a limit cycle of metres; the hand point ahead damps it."""
    run = in_the_followers_frame(LAG)
    assert 1.5 < run.rms() < 2.6
    assert 3.5 < run.distance(after=40.0).max() < 5.0
    assert simulate(speed=faster, yaw_rate=weave, lag=LAG).rms() < 0.2


def test_output_in_the_followers_frame_diverges_with_lag_and_a_short_hand():
    """If it is not led back either; in the leader's frame the short hand is as good."""
    assert in_the_followers_frame(LAG, **SHORT_HAND, **RUSHING).rms() > 25.0
    assert simulate(speed=faster, yaw_rate=weave, lag=LAG, parameters=SHORT_HAND).rms() <= 0.25


@pytest.mark.parametrize(("hidden", "rms"), [(1 / 2, 0.885), (1 / 10, 0.0755)])
def test_a_fast_hidden_layer_swings_behind_slow_cars(hidden, rms):
    """K = 3, F = K^2/7, and G by its share of F; speed and yaw rate lag by 0.3 s each, so that K tau is not small."""
    learning = {"gain": 3.0, "adaptation.output": 9 / 7, "adaptation.hidden": hidden * 9 / 7}
    run = simulate(speed=faster, yaw_rate=weave, lag=0.3, parameters=learning)
    assert run.rms(after=20.0) == pytest.approx(rms, rel=0.15)


def test_twice_the_gain_is_an_error_of_a_quarter():
    """The error is the rate of what has to be learnt over K_i, and K_i goes with K^2."""
    firm = {"gain": 4.0, "adaptation.output": 2.28, "adaptation.hidden": 1.2}
    soft, hard = (simulate(speed=faster, yaw_rate=weave, parameters=p) for p in ({}, firm))
    assert hard.rms() <= 0.06
    assert soft.rms() / hard.rms() == pytest.approx(4.0, rel=0.15)


HASTY = {"adaptation.fastest": 1e6}
TAUGHT = {"freeze_limited": 0}


def from_36_metres(output: float, hidden: float, **parameters: float) -> Run:
    """Nothing learnt, rushing, far outside of what speed and grip allow: F, G and parameters."""
    learning = {"adaptation.output": output, "adaptation.hidden": hidden, **parameters}
    return simulate(
        speed=faster,
        yaw_rate=weave,
        start=(-30.0, 20.0),
        duration=30.0,
        parameters={**learning, **UNLIMITED_RATES, **ZERO_WEIGHTS, **RUSHING},
    )


@pytest.mark.parametrize(("output", "hidden"), [(0.57, 0.3), (5.0, 2.5), (50.0, 0.3), (200.0, 1.0)])
def test_weights_stay_small_under_saturation(output, hidden):
    """|W| <= 15 whatever the gains, and the place is kept."""
    run = from_36_metres(output, hidden)
    assert run.outputs["saturation.yaw_rate"].sum() > 50
    assert run.outputs["weights.norm"].max() < 15.0
    assert run.rms(after=20.0) < 0.12


@pytest.mark.parametrize(("output", "hidden"), [(0.57, 0.3), (5.0, 2.5)])
def test_the_freeze_alone_keeps_weights_small_at_moderate_gains(output, hidden):
    """And nothing else does where what is learnt may change as fast as it likes."""
    frozen, taught = (from_36_metres(output, hidden, **HASTY, **how) for how in ({}, TAUGHT))
    assert frozen.outputs["weights.norm"].max() < 14.0
    assert frozen.rms(after=20.0) < 0.12
    assert taught.outputs["weights.norm"].max() > 300.0
    assert taught.rms(after=20.0) > 20.0


@pytest.mark.parametrize(("output", "hidden"), [(50.0, 0.3), (200.0, 1.0)])
def test_at_large_gains_it_takes_a_slow_network_as_well_as_the_freeze(output, hidden):
    """Frozen but hasty the weights grow and the place is lost; slow but taught they stay small, less well placed."""
    hasty, taught = (from_36_metres(output, hidden, **how) for how in (HASTY, TAUGHT))
    assert hasty.outputs["weights.norm"].max() > 30.0
    assert hasty.rms(after=20.0) > 20.0
    assert taught.outputs["weights.norm"].max() < 17.0
    assert 0.15 < taught.rms(after=20.0) < 0.4


class Radio:
    """The leader's pose at 10 Hz, 20 ms late, with noise."""

    def __init__(self, noise: float, noise_yaw: float) -> None:
        self._rng, self._noise = np.random.default_rng(1), (noise, noise, noise_yaw)
        self._sent: list[tuple[int, Message]] = []

    def __call__(self, k: int, leader: Unicycle) -> Message:
        if k % 5 == 0:
            shift = self._rng.normal(size=3) * self._noise
            self._sent.append(
                (k, {name: value + d for (name, value), d in zip(pose(leader).items(), shift, strict=True)})
            )
        heard = [message for message in self._sent if message[0] + 1 <= k]
        if not heard:
            return {"leader.valid": 0.0, "leader.age": k * T}
        return {**heard[-1][1], "leader.valid": 1.0, "leader.age": (k - heard[-1][0]) * T}


@pytest.mark.parametrize(("noise", "noise_yaw"), [(0.0, 0.0), (0.02, 0.002)])
def test_messages_at_10_hz_are_carried_forward(noise, noise_yaw):
    """A message is up to 0.12 s old, 3.6 m at 30 m/s; commands do not jump as one comes in."""
    run = simulate(speed=faster, yaw_rate=weave, lag=LAG, hear=Radio(noise, noise_yaw), duration=40.0)
    assert run.rms() <= 0.25
    turns, speeds = (np.diff(run.outputs[f"command.{name}"])[50:] for name in ("yaw_rate", "speed"))
    assert turns.std() < (0.0025 if noise == 0 else 0.01)
    assert np.abs(speeds).max() < 0.08


def test_offset_moves_smoothly_and_its_rate_is_known():
    """From the right rear to the left rear: 8 m across within 6 s, errors as without the change."""

    def change(t):
        return {"formation.x": -12.0, "formation.y": 4.0 if t < 10 else -4.0}

    run = simulate(speed=lambda t: 25.0, yaw_rate=lambda t: 0.0, duration=25.0, inputs=change)
    assert run.outputs["offset.y"][-1] == -4.0
    assert np.abs(np.diff(run.outputs["offset.y"])).max() < 1.88 * 8 / 6 * T
    assert run.distance(after=5.0).max() < 0.25


@pytest.mark.parametrize(("before", "after"), [((-12.0, 4.0), (-60.0, 4.0)), ((-60.0, 0.0), (-12.0, 0.0))])
def test_a_far_new_place_is_approached_within_the_limits_and_the_follower_stays_in_it(before, after):
    """48 m along the road take longer than formation.duration: half of the acceleration, 2 m/s2, is never exceeded."""

    def change(t):
        x, y = before if t < 5 else after
        return {"formation.x": x, "formation.y": y}

    straight = {"speed": lambda t: 20.0, "yaw_rate": lambda t: 0.0, "lag": LAG}
    run = simulate(**straight, r=before, duration=25.0, inputs=change)
    offset = np.column_stack([run.outputs[f"offset.{axis}"] for axis in "xy"])
    reached = run.time[np.abs(offset - after).max(axis=1) > 0.0][-1] - 5.0
    assert reached == pytest.approx(np.sqrt(10 / np.sqrt(3) * 48.0 / 2.0), abs=0.1)
    speed = np.diff(offset, axis=0) / T
    assert np.abs(np.diff(speed, axis=0)).max() / T < 2.0 * 1.01  # so nothing jumps
    assert np.abs(np.diff(speed, n=2, axis=0)).max() / T**2 < 1.01 * 60 * 48.0 / reached**3
    assert not run.outputs["saturation.speed"].any()
    assert run.distance().max() < 1.0


def test_behind_a_slow_leader_a_place_moves_back_slowly_enough_to_wait_for_it():
    """24 m back at 5 m/s: at half of that, for a follower cannot reverse."""
    slow = {"speed": lambda t: 5.0, "yaw_rate": lambda t: 0.0, "lag": LAG, "r": (-12.0, 0.0)}
    run = simulate(**slow, duration=35.0, inputs=lambda t: {"formation.x": -12.0 if t < 5 else -36.0})
    assert np.diff(run.outputs["offset.x"]).min() / T == pytest.approx(-2.5, abs=0.05)
    assert run.outputs["offset.x"][-1] == -36.0
    assert not run.outputs["saturation.speed"].any()
    assert run.distance().max() < 0.5


@pytest.mark.parametrize("start", [(-60.0, 0.0), (40.0, 0.0), (-30.0, -25.0)])
def test_from_afar_the_place_is_reached_without_overshoot(start):
    """Led there on a gentle course; rushing, the same car shoots past by many metres."""
    led, rushing = (
        simulate(speed=lambda t: 20.0, yaw_rate=lambda t: 0.0, lag=LAG, start=start, duration=30.0, parameters=p)
        for p in ({}, RUSHING)
    )
    assert past_the_place(led, start) < 0.1
    assert led.outputs["offset.x"][-1] == -12.0
    assert led.rms(after=20.0) < 0.05
    assert led.outputs["saturation.speed"].mean() < 0.1
    assert past_the_place(rushing, start) > 3.0


def past_the_place(run: Run, start: tuple[float, float]) -> float:
    """How far beyond its place, seen from `start`, a follower came whose leader drives straight along x [m]."""
    offset = np.column_stack([run.outputs[f"offset.{axis}"] for axis in "xy"]) - (-12.0, 4.0)
    return float((-(offset + run.z) @ np.array(start)).max() / np.linalg.norm(start))


@pytest.mark.parametrize("gain", [1.0, 2.0])
def test_a_follower_that_knows_nothing_learns_although_it_is_led(gain):
    """W = 0 behind a leader at 30 m/s: the place stays 5 m off until what pulls it back has taught enough."""
    learning = {"gain": gain, "adaptation.output": gain**2 / 7, "adaptation.hidden": gain**2 / 14, **ZERO_WEIGHTS}
    run = simulate(speed=lambda t: 30.0, yaw_rate=lambda t: 0.0, lag=LAG, duration=60.0, parameters=learning)
    assert run.outputs["offset.x"][-1] == -12.0
    assert run.rms(after=55.0) < 0.1


def test_headway_opens_the_gap_with_the_speed():
    run = simulate(speed=faster, yaw_rate=lambda t: 0.0, parameters={"headway": 0.8}, duration=60.0)
    assert run.outputs["offset.x"][-1] == pytest.approx(-12.0 - 0.8 * 30.0, abs=0.1)
    assert run.rms(after=20.0) < 0.5


def test_broadcast_speed_leaves_little_to_learn():
    """A leader that gains 10 m/s at 2 m/s2, its speed known to all at once, from the first message on."""

    def rush(t):
        return 20.0 + min(max(2.0 * (t - 5.0), 0.0), 10.0)

    told = simulate(
        speed=rush,
        yaw_rate=lambda t: 0.0,
        duration=20.0,
        parameters={"feedforward.enabled": 1},
        hear=lambda k, leader: {**pose(leader), "leader.valid": float(k > 2)},
        inputs=lambda t: {"feedforward.speed": rush(t) if t > 0.05 else 0.0},
    )
    untold = simulate(speed=rush, yaw_rate=lambda t: 0.0, duration=20.0)
    assert told.distance().max() < 0.4
    assert untold.distance().max() > 0.8
    assert told.outputs["velocity.x"][-1] == pytest.approx(30.0, abs=0.1)


@pytest.mark.parametrize("first", [0.1, 1e9])
def test_a_speed_not_yet_heard_is_none(first):
    """The port shows 0 until then: the follower drives as one that is not told anything."""

    def hear(t):
        return {"feedforward.speed": 25.0 if t > first else 0.0, "feedforward.valid": float(t > first)}

    straight = {"speed": lambda t: 25.0, "yaw_rate": lambda t: 0.0, "lag": LAG, "duration": 8.0}
    run = simulate(**straight, parameters={"feedforward.enabled": 1}, inputs=hear)
    untold = simulate(**straight)
    assert run.distance().max() < 1.5 * untold.distance().max() < 0.1
    assert np.abs(run.outputs["command.speed"] - 25.0).max() < 0.1


@pytest.mark.parametrize("frame", [0, 1])
def test_the_first_broadcast_replaces_what_was_learnt_without_a_jump(frame):
    """Told in a bend, at 4 s and then no more: the commands go on as if nothing had happened, the weights shrink."""

    def hear(t):
        return {"feedforward.speed": 23.0 if 4.0 < t < 4.5 else 0.0, "feedforward.valid": float(4.0 < t < 4.5)}

    bend = {"speed": lambda t: 25.0, "yaw_rate": lambda t: 0.1, "duration": 8.0}
    told, untold = (
        simulate(**bend, parameters={"feedforward.enabled": on, "leader_frame": frame}, inputs=hear) for on in (1, 0)
    )
    just = np.searchsorted(told.time, 4.0) + 3
    for name in ("command.speed", "command.yaw_rate", "velocity.x", "velocity.y"):
        np.testing.assert_allclose(told.outputs[name][:just], untold.outputs[name][:just], atol=0.01, err_msg=name)
    assert told.outputs["weights.norm"][just] < 0.3 * untold.outputs["weights.norm"][just]
    assert told.distance().max() < 0.5
    assert np.abs(np.diff(told.outputs["command.speed"])[2:]).max() < 0.02
