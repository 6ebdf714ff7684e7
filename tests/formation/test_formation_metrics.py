"""The metrics of a formation on motions whose figures are known: complex arithmetic, closed forms, brute force."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest
from formation_table import STEP, drive

from cosim import display
from cosim.scenarios import _formation_metrics as metrics
from cosim.scenarios._distances import Body, distance_metrics, smallest_distance
from fmukit.interface import load_parameters
from fmus.controllers.formation import bus

N = 1001
TIME = STEP * np.arange(N)
CAR = Body(2.0, 2.3, 1.68)


def circle(radius: float, speed: float, phase: float) -> np.ndarray:
    angle = phase + speed / radius * TIME
    return np.column_stack((radius * np.sin(angle), -radius * np.cos(angle), angle))


def random_poses(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-50, 50, (N, 3))


def test_the_error_is_that_of_the_hand_point_in_the_followers_axes() -> None:
    own, leader = random_poses(1), random_poses(2)
    found = metrics.follower_errors(drive({1: leader, 2: own}, {2: (-12.0, 4.0)}, {"hand.distance": 7.0}), 2, 1)
    place, ahead = own[:, 0] + 1j * own[:, 1], leader[:, 0] + 1j * leader[:, 1]
    turn, its = np.exp(1j * own[:, 2]), np.exp(1j * leader[:, 2])
    for a, z in ((7.0, found.hand), (0.0, found.position)):
        wanted = (place + a * turn - ahead - its * (-12.0 + a + 4.0j)) / turn
        np.testing.assert_allclose(z, np.column_stack((wanted.real, wanted.imag))[:-1], atol=1e-12)


def test_a_follower_in_its_place_has_no_error_where_it_is_controlled_and_a_known_one_at_O1() -> None:
    """On the leader's circle the hand point can be in its place; the tail then lies 2 a sin(gamma/2) beside its own."""
    leader = circle(100.0, 20.0, 0.0)
    gamma, a = -0.1, metrics.HAND
    own = circle(100.0, 20.0, gamma)
    p = own[:, 0] + 1j * own[:, 1] + a * np.exp(1j * own[:, 2]) - leader[:, 0] - 1j * leader[:, 1]
    r = p / np.exp(1j * leader[:, 2]) - a
    results = drive({1: leader, 2: own}, {2: (float(r[0].real), float(r[0].imag))})
    found = metrics.formation_metrics(results, {2: 1})
    assert found["car2.formation_error_max"] < 1e-9
    assert found["position_error_rms"] == pytest.approx(2 * a * math.sin(abs(gamma) / 2), rel=1e-9)


def test_root_mean_square_largest_and_worst() -> None:
    straight = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    wave = np.column_stack((0.3 * np.sin(2 * np.pi * TIME / 5), 0 * TIME, 0 * TIME))
    poses = {1: straight, 2: straight - [12, 0, 0] + wave, 3: straight - [24, 0, 0] + 3 * wave}
    found = metrics.formation_metrics(drive(poses, {2: (-12.0, 0.0), 3: (-12.0, 0.0)}), {2: 1, 3: 2})
    assert found["car2.formation_error_rms"] == pytest.approx(0.3 / math.sqrt(2), rel=1e-3)
    assert found["car3.formation_error_max"] == pytest.approx(0.6, rel=1e-3)
    assert found["formation_error_max"] == found["car3.formation_error_max"]
    crest = metrics.formation_metrics(drive(poses, {2: (-12.0, 0.0)}), {2: 1}, begin=18.76)
    assert crest["formation_error_rms"] == pytest.approx(0.3 * math.sqrt(0.5), rel=0.01)


def test_settling_of_an_exponential_and_the_largest_error_of_each_change() -> None:
    """The place jumps by 5 m, the distance to it decays with 1 s: 0.3 m after ln(5/0.3) s."""
    jump = np.where(TIME >= 4.0, -17.0, -12.0)
    gap = np.where(TIME >= 4.0, -17.0 + 5.0 * np.exp(-(TIME - 4.0)), -12.0)
    leader = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    own = leader + np.column_stack((gap, 0 * TIME, 0 * TIME))
    late = 0.2 * (np.abs(TIME - 6.0) < 0.01)
    columns = {"car2__follower__formation__x": jump, "car2__follower__offset__x": gap - late}
    results = drive({1: leader, 2: own}, {2: (-12.0, 0.0)}, **columns)
    found = metrics.formation_metrics(results, {2: 1})
    assert found["car2.settling_time"] == pytest.approx(math.log(5 / 0.3), abs=STEP)
    assert found["change_error_max"] == pytest.approx(0.2)


def test_a_place_never_reached_has_no_settling_time_and_headway_is_part_of_the_place() -> None:
    leader = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    own = leader - [32.0, 0.0, 0.0]
    columns = {
        "car2__follower__formation__x": np.where(TIME > 1, -12.0, -10.0),
        "car2__plant__velocity__x": 20 + 0 * TIME,
    }
    for headway, unknown in ((0.0, True), (1.0, False)):
        results = drive({1: leader, 2: own}, {2: (-32.0, 0.0)}, {"headway": headway}, **columns)
        assert math.isnan(metrics.formation_metrics(results, {2: 1})["settling_time"]) == unknown


def test_a_follower_that_leads_itself_back_is_far_from_its_place_though_it_has_no_error() -> None:
    """It is commanded 17 m behind from 4 s on, is there at 10 s, and drops back by 30 m for a while at 15 s."""
    leader = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    offset = np.interp(TIME, [4.0, 10.0, 14.0, 15.0, 16.0], [-12.0, -17.0, -17.0, -47.0, -17.0])
    own = leader + np.column_stack((offset, 0 * TIME, 0 * TIME))
    jump = np.where(TIME >= 4.0, -17.0, -12.0)
    columns = {"car2__follower__formation__x": jump, "car2__follower__offset__x": offset}
    found = metrics.formation_metrics(drive({1: leader, 2: own}, {2: (0.0, 0.0)}, **columns), {2: 1})
    assert found["formation_error_max"] < 1e-9
    assert found["place_error_max"] == pytest.approx(30.0)
    calm = metrics.formation_metrics(drive({1: leader, 2: leader - [12.0, 0.0, 0.0]}, {2: (-12.0, 0.0)}), {2: 1})
    assert calm["place_error_max"] == 12.0  # it was never told where to be, so beside its leader
    told = {"formation.x": "-12", "formation.y": 0.0}
    calm = metrics.formation_metrics(drive({1: leader, 2: leader - [12.0, 0.0, 0.0]}, {2: (-12.0, 0.0)}, told), {2: 1})
    assert calm["place_error_max"] < 1e-9


def test_without_followers_everything_is_unknown() -> None:
    results = drive({1: random_poses(1)}, {})
    found = metrics.formation_metrics(results, {}) | distance_metrics(results, [1])
    assert found
    assert all(math.isnan(value) for value in found.values())


def test_effort() -> None:
    omega = 0.1 * np.sin(2 * np.pi * TIME / 5)
    columns = {
        "car2__plant__velocity__x": 20 + 0 * TIME,
        "car2__plant__angular_rate__z": omega,
        "car2__follower__command__acceleration": np.where(TIME < 10, 1.0, -3.0),
    }
    found = metrics.formation_metrics(drive({1: random_poses(1), 2: random_poses(2)}, {2: (0, 0)}, **columns), {2: 1})
    assert found["lateral_acceleration_rms"] == pytest.approx(2 / math.sqrt(2), rel=1e-3)
    assert found["acceleration_rms"] == pytest.approx(math.sqrt(5), rel=1e-3)


def sampled(pose: np.ndarray, body: Body, points: int = 60) -> np.ndarray:
    """Points on the edges of a rectangle."""
    u = np.linspace(0, 1, points)
    x = [-body.behind, body.ahead]
    y = [-body.width / 2, body.width / 2]
    edges = [x[0] + u * (x[1] - x[0]) + 1j * y[i] for i in (0, 1)]
    edges += [x[i] + 1j * (y[0] + u * (y[1] - y[0])) for i in (0, 1)]
    return pose[0] + 1j * pose[1] + np.exp(1j * pose[2]) * np.concatenate(edges)


def test_the_smallest_distance_is_that_of_all_pairs_at_all_times() -> None:
    """Against the nearest of points on the edges of all rectangles, which are up to 0.04 m apart."""
    rng = np.random.default_rng(4)
    for _ in range(10):
        grid = np.array([[15.0 * i, 12.0 * j, 0.0] for i in range(3) for j in range(2)])
        poses = grid + rng.uniform(-1, 1, (5, 6, 3)) * [3.0, 2.0, 3.0]
        edges = np.array([[sampled(pose, CAR) for pose in row] for row in poses])
        least = min(
            np.abs(edges[t, i][:, None] - edges[t, j]).min() for t in range(5) for i in range(6) for j in range(i)
        )
        assert smallest_distance(poses, CAR) == pytest.approx(least, abs=0.02)


def test_cars_that_overlap_collide() -> None:
    one = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    two = one - [10.0, 0.0, 0.0] + np.column_stack((8.0 * np.exp(-((TIME - 10) ** 2)), 0 * TIME, 0 * TIME))
    assert distance_metrics(drive({1: one, 2: two}, {}), [1, 2]) == {"distance_min": 0.0, "collision": 1.0}
    apart = distance_metrics(drive({1: one, 2: one - [10.0, 0.0, 0.0]}, {}), [1, 2])
    assert apart == {"distance_min": pytest.approx(10.0 - 4.3), "collision": 0.0}


def test_a_touch_in_any_block_of_times_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cosim.scenarios._distances._BLOCK", 7)
    poses = np.zeros((100, 3, 3))
    poses[:, :, 0] = [0.0, -20.0, -40.0]
    poses[63, 2, 0] = -30.0
    assert smallest_distance(poses, CAR) == pytest.approx(10.0 - 4.3)


def test_what_is_assumed_of_followers_is_their_start_value() -> None:
    file = Path(bus.__file__).with_name("parameters.toml")
    starts = {v.name: v.start for v in load_parameters(file)}
    assert starts["hand.distance"] == metrics.HAND
    assert starts["formation.duration"] == metrics.DURATION


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("car12.formation_error_rms", "m"),
        ("car2.place_error_max", "m"),
        ("car2.lateral_acceleration_rms", "m/s2"),
        ("car2.lateral_error_max", "m"),
        ("car3.settling_time", "s"),
        ("string_gain_max", ""),
        ("car3.string_ratio_max", ""),
        ("collision", ""),
    ],
)
def test_metrics_of_a_car_are_shown_with_their_units(name: str, unit: str) -> None:
    assert display._readable(name, 1.0) == ("1.0000", unit)
