"""The metrics of a formation on motions whose figures are known: complex arithmetic, closed forms, brute force."""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np
import pyarrow as pa
import pytest
from formation_table import STARTS, STEP, drive

from cosim.results.reading import Results
from scenarios.formation.course import course
from scenarios.formation.distances import Outline, distance_metrics, smallest_distance
from scenarios.formation.errors import errors_of_followers, follower_errors
from scenarios.formation.metrics import follower_metrics, formation_metrics, warn_of_few_rows
from scenarios.formation.timetable import Formation
from tests.references import trailing_rod

N = 1001
TIME = STEP * np.arange(N)
CAR = Outline(2.0, 2.3, 1.68)


def circle(radius: float, speed: float, phase: float) -> np.ndarray:
    angle = phase + speed / radius * TIME
    return np.column_stack((radius * np.sin(angle), -radius * np.cos(angle), angle))


def quintic(r0: float, r1: float, begin: float, duration: float) -> np.ndarray:
    """From rest to rest, by its closed form."""
    tau = np.clip((TIME - begin) / duration, 0.0, 1.0)
    return np.asarray(r0 + (r1 - r0) * tau**3 * (10 - 15 * tau + 6 * tau**2))


def straight(gap: np.ndarray | float) -> dict[int, np.ndarray]:
    leader = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    return {1: leader, 2: leader + np.column_stack((gap + 0 * TIME, 0 * TIME, 0 * TIME))}


def measured(results: Results, leaders: Mapping[int, int]) -> dict[str, float]:
    """The values of the metrics of the followers."""
    found = follower_metrics(results, errors_of_followers(results, leaders))
    return {name: metric.value for name, metric in found.items()}


def random_poses(seed: int) -> np.ndarray:
    return np.random.default_rng(seed).uniform(-50, 50, (N, 3))


def test_the_error_is_that_of_the_hand_point_in_the_followers_axes() -> None:
    own, leader = random_poses(1), random_poses(2)
    found = follower_errors(drive({1: leader, 2: own}, {2: (-12.0, 4.0)}, {"hand.distance": 7.0}), 2, 1)
    place, ahead = own[:, 0] + 1j * own[:, 1], leader[:, 0] + 1j * leader[:, 1]
    turn, its = np.exp(1j * own[:, 2]), np.exp(1j * leader[:, 2])
    for a, z in ((7.0, found.hand), (0.0, found.position)):
        wanted = (place + a * turn - ahead - its * (-12.0 + a + 4.0j)) / turn
        np.testing.assert_allclose(z, np.column_stack((wanted.real, wanted.imag))[:-1], atol=1e-12)


def test_a_follower_in_its_place_has_no_error_where_it_is_controlled_and_a_known_one_at_O1() -> None:
    """On the leader's circle the hand point can be in its place; the tail then lies 2 a sin(gamma/2) beside its own."""
    leader = circle(100.0, 20.0, 0.0)
    gamma, a = -0.1, float(STARTS["hand.distance"])
    own = circle(100.0, 20.0, gamma)
    p = own[:, 0] + 1j * own[:, 1] + a * np.exp(1j * own[:, 2]) - leader[:, 0] - 1j * leader[:, 1]
    r = p / np.exp(1j * leader[:, 2]) - a
    results = drive({1: leader, 2: own}, {2: (float(r[0].real), float(r[0].imag))})
    found = measured(results, {2: 1})
    assert found["car2.formation_error_max"] < 1e-9
    assert found["position_error_rms"] == pytest.approx(2 * a * math.sin(abs(gamma) / 2), rel=1e-9)


def test_root_mean_square_largest_and_worst() -> None:
    straight = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    wave = np.column_stack((0.3 * np.sin(2 * np.pi * TIME / 5), 0 * TIME, 0 * TIME))
    poses = {1: straight, 2: straight - [12, 0, 0] + wave, 3: straight - [24, 0, 0] + 3 * wave}
    found = measured(drive(poses, {2: (-12.0, 0.0), 3: (-12.0, 0.0)}), {2: 1, 3: 2})
    assert found["car2.formation_error_rms"] == pytest.approx(0.3 / math.sqrt(2), rel=1e-3)
    assert found["car3.formation_error_max"] == pytest.approx(0.6, rel=1e-3)
    assert found["formation_error_max"] == found["car3.formation_error_max"]


def test_settling_of_an_exponential_and_the_largest_error_of_each_change() -> None:
    """The place jumps by 5 m, and the follower moves there on the quintic: 0.3 m are left when that has 0.06 left."""
    jump = np.where(TIME >= 4.0, -17.0, -12.0)
    gap = quintic(-12.0, -17.0, 4.0, 6.0)
    leader = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    own = leader + np.column_stack((gap, 0 * TIME, 0 * TIME))
    late = 0.2 * (np.abs(TIME - 6.0) < 0.01)
    columns = {"car2__follower__formation__x": jump, "car2__follower__offset__x": gap - late}
    results = drive({1: leader, 2: own}, {2: (-12.0, 0.0)}, **columns)
    found = measured(results, {2: 1})
    assert found["car2.settling_time"] == pytest.approx(6.0 * 0.7973, abs=STEP)
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
        assert math.isnan(measured(results, {2: 1})["settling_time"]) == unknown


def test_a_follower_that_leads_itself_back_has_the_error_from_where_it_was_commanded() -> None:
    """It is commanded 17 m behind from 4 s on, is there at 10 s, and drops back by 30 m for a while at 15 s."""
    back = np.interp(TIME, [14.0, 15.0, 16.0], [0.0, -30.0, 0.0])
    offset = quintic(-12.0, -17.0, 4.0, 6.0) + back
    jump = np.where(TIME >= 4.0, -17.0, -12.0)
    columns = {"car2__follower__formation__x": jump, "car2__follower__offset__x": offset}
    found = measured(drive(straight(offset), {2: (-12.0, 0.0)}, **columns), {2: 1})
    assert found["formation_error_max"] == pytest.approx(30.0)
    assert found["place_error_max"] == pytest.approx(30.0)
    calm = (TIME < 4.0) | (TIME >= 10.0)
    assert found["place_error_rms"] == pytest.approx(math.sqrt(np.mean(back[calm] ** 2)), rel=1e-2)
    assert found["led_back_time"] == pytest.approx(2.0 * 29 / 30, abs=2 * STEP)


def test_a_follower_never_told_where_to_be_is_wanted_beside_its_leader() -> None:
    told = {"formation.x": 0.0}
    found = measured(drive(straight(-12.0), {2: (-12.0, 0.0)}, told), {2: 1})
    assert (found["place_error_max"], found["formation_error_max"]) == pytest.approx((12.0, 12.0))


@pytest.mark.parametrize("late", [0.0, 0.3])
def test_a_follower_that_only_smooths_what_it_is_told_is_not_led_back(late: float) -> None:
    """Also where a second change begins on the way; its error is then that to the course it gives."""
    jump = np.select([TIME >= 7.0, TIME >= 4.0], [-14.0, -17.0], -12.0)
    commanded = course(TIME, np.column_stack((jump, 0 * jump)), 6.0)[:, 0]
    given = np.interp(TIME - STEP, TIME, commanded)
    columns = {"car2__follower__formation__x": jump, "car2__follower__offset__x": given}
    found = measured(drive(straight(given - late), {2: (-12.0, 0.0)}, **columns), {2: 1})
    assert found["led_back_time"] == 0.0
    assert found["formation_error_max"] == pytest.approx(late, abs=1e-9)
    assert found["place_error_rms"] == pytest.approx(late, abs=0.02)


def test_the_course_commanded_is_smooth_and_ends_where_it_is_told() -> None:
    """From rest the closed form, begun anew on the way without a jump up to the second derivative."""
    jump = np.select([TIME >= 7.0, TIME >= 4.0], [-14.0, -17.0], -12.0)
    found = course(TIME, np.column_stack((jump, 2 * jump)), 6.0)
    np.testing.assert_allclose(found[:, 1], 2 * found[:, 0], rtol=1e-12)
    first = TIME < 7.0
    np.testing.assert_allclose(found[first, 0], quintic(-12.0, -17.0, 4.0, 6.0)[first], atol=1e-9)
    acceleration = np.diff(found[:, 0], 2) / STEP**2
    assert np.abs(np.diff(acceleration)).max() < 0.06
    assert np.abs(acceleration[(TIME[1:-1] > 6.9) & (TIME[1:-1] < 7.1)]).max() < 0.3
    np.testing.assert_allclose(found[TIME >= 13.0, 0], -14.0, atol=1e-9)


@pytest.mark.parametrize(("further", "led_back"), [(0.0, 0.0), (12.0, (N - 1) * STEP)])
def test_headway_is_that_of_a_speed_the_follower_may_take_for_its_own(further: float, led_back: float) -> None:
    """Braking with 5 m/s2, seen 0.3 s late: 1.5 m from the place at the true speed, and still the follower's course."""
    speed, seen = (np.clip(30.0 - 5.0 * (TIME - begin), 10.0, 30.0) for begin in (5.0, 5.3))
    given = -12.0 - further - seen
    columns = {"car2__plant__velocity__x": speed, "car2__follower__offset__x": given}
    found = measured(drive(straight(given), {2: (-12.0, 0.0)}, {"headway": 1.0}, **columns), {2: 1})
    assert found["led_back_time"] == pytest.approx(led_back)
    assert found["formation_error_max"] == pytest.approx(0.0 if not further else 13.5, abs=0.05)


def test_before_its_first_output_a_follower_is_wanted_where_it_was_commanded() -> None:
    """As with Jacobi's scheme, where outputs come one step late."""
    offset = np.where(TIME < 0.01, 0.0, -12.0)
    results = drive(straight(-12.0), {2: (-12.0, 0.0)}, car2__follower__offset__x=offset)
    found = measured(results, {2: 1})
    assert found["formation_error_max"] < 1e-9
    assert found["led_back_time"] == 0.0


@pytest.mark.parametrize(("every", "unknown", "said"), [(500, True, "once"), (5, False, "every 0.1 s"), (1, False, "")])
def test_rows_too_far_apart_are_said_or_give_no_figures(
    every: int, unknown: bool, said: str, caplog: pytest.LogCaptureFixture
) -> None:
    full = drive(straight(-12.0), {2: (-12.0, 0.0)})
    table = pa.table(
        {name: (full.time if name == "time" else full[name])[:501:every] for name in ("time", *full.names)}
    )
    results = Results(table, full.facts)
    assert math.isnan(measured(results, {2: 1})["formation_error_max"]) == unknown
    warn_of_few_rows(results, {2: 1})
    assert [said in record.getMessage() for record in caplog.records] == [True] * (every > 1)


def test_without_followers_everything_is_unknown() -> None:
    results = drive({1: random_poses(1)}, {})
    found = formation_metrics(results, Formation({}, {}, in_a_row=True))
    assert found
    assert all(math.isnan(metric.value) for metric in found.values())


def test_effort() -> None:
    omega = 0.1 * np.sin(2 * np.pi * TIME / 5)
    columns = {
        "car2__plant__velocity__x": 20 + 0 * TIME,
        "car2__plant__angular_rate__z": omega,
        "car2__follower__command__acceleration": np.where(TIME < 10, 1.0, -3.0),
    }
    found = measured(drive({1: random_poses(1), 2: random_poses(2)}, {2: (0, 0)}, **columns), {2: 1})
    assert found["lateral_acceleration_rms"] == pytest.approx(2 / math.sqrt(2), rel=1e-3)
    assert found["acceleration_rms"] == pytest.approx(math.sqrt(5), rel=1e-3)


def sampled(pose: np.ndarray, outline: Outline, points: int = 60) -> np.ndarray:
    """Points on the edges of a rectangle."""
    u = np.linspace(0, 1, points)
    x = [-outline.behind, outline.ahead]
    y = [-outline.width / 2, outline.width / 2]
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


def distances(results: Results) -> dict[str, float]:
    return {name: metric.value for name, metric in distance_metrics(results, [1, 2]).items()}


def test_cars_that_overlap_collide() -> None:
    one = np.column_stack((20.0 * TIME, 0 * TIME, 0 * TIME))
    two = one - [10.0, 0.0, 0.0] + np.column_stack((8.0 * np.exp(-((TIME - 10) ** 2)), 0 * TIME, 0 * TIME))
    assert distances(drive({1: one, 2: two}, {})) == {"distance_min": 0.0, "collision": 1.0}
    apart = distances(drive({1: one, 2: one - [10.0, 0.0, 0.0]}, {}))
    assert apart == {"distance_min": pytest.approx(10.0 - 4.3), "collision": 0.0}


def test_a_touch_in_any_block_of_times_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("scenarios.formation.distances.BLOCK", 7)
    poses = np.zeros((100, 3, 3))
    poses[:, :, 0] = [0.0, -20.0, -40.0]
    poses[63, 2, 0] = -30.0
    assert smallest_distance(poses, CAR) == pytest.approx(10.0 - 4.3)


def test_metrics_carry_their_units() -> None:
    poses = {1: random_poses(1), 2: random_poses(2), 3: random_poses(3)}
    results = drive(poses, {2: (-12.0, 0.0), 3: (-12.0, 0.0)})
    found = formation_metrics(results, Formation({2: 1, 3: 2}, {2: (-12.0, 0.0), 3: (-12.0, 0.0)}, in_a_row=True))
    units = {
        "car2.formation_error_rms": "m",
        "position_error_max": "m",
        "car3.place_error_max": "m",
        "change_error_max": "m",
        "car2.settling_time": "s",
        "car3.led_back_time": "s",
        "acceleration_rms": "m/s2",
        "car2.lateral_acceleration_rms": "m/s2",
        "car3.string_ratio_max": "1",
        "distance_min": "m",
        "collision": "1",
    }
    assert {name: found[name].unit for name in units} == units


def test_in_trailing_axes_the_error_is_that_to_the_end_of_a_rod_from_the_true_head() -> None:
    """The rod is integrated on its own; the follower is 0.2 m further back than its hand is wanted."""
    a, place = 7.0, complex(-30.0, 8.0)
    leader = circle(100.0, 20.0, 0.0)

    def hand(t: float) -> complex:
        angle = 20.0 / 100.0 * t
        return complex(100.0 * (np.sin(angle) - 1j * np.cos(angle)) + a * np.exp(1j * angle))

    psi = trailing_rod.angles(hand, lambda _: abs(place), 0.0, TIME)
    own = np.array([hand(t) for t in TIME]) + np.exp(1j * psi) * (place - 0.2 - a)
    poses = {1: leader, 2: np.column_stack((own.real, own.imag, psi))}
    told = {"hand.distance": a, "frame.trailing": 1.0}
    found = follower_errors(drive(poses, {2: (place.real, place.imag)}, told), 2, 1)
    for error in (found.hand, found.position, found.place):
        np.testing.assert_allclose(error, np.tile([-0.2, 0.0], (N - 1, 1)), atol=1e-3)
    np.testing.assert_allclose(found.seen, np.tile([place.real - 0.2, place.imag], (N - 1, 1)), atol=1e-3)
