"""An obstacle appears: each action driven on the real FMUs, and what the pictures and metrics are made of."""

import math

import numpy as np
import pytest

from cosim.errors import CosimError
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load
from cosim.scenario.metric import Metric
from fmus.planner.evasion.decision import decide
from fmus.planner.evasion.situation import Encounter, Surroundings
from fmus.planner.evasion.table import read
from scenarios.collision_avoidance.geometry import car, clearance, obstacle
from scenarios.shared.rectangles import footprint, separation

NAME = "collision-avoidance"
BRAKE = ("scenario.distance=50",)
BOTH = ("scenario.distance=35.3",)
FAST = ("scenario.speed=35", "scenario.distance=92")
SLIPPERY = ("scenario.friction=0.3", "scenario.distance=64.4", "scenario.speed=30")
NEITHER = ("scenario.distance=25",)


def driven_to_its_end(scenario_run, assignments):
    """The run; where nothing is avoided its mission is missed."""
    return scenario_run(NAME, *assignments, status="missed" if assignments == NEITHER else "ok")


def test_braking_stops_before_the_obstacle(scenario_run):
    metrics = scenario_run(NAME, *BRAKE).summary.metrics
    assert metrics["decision"].value == 0
    assert metrics["stop_distance"].value == pytest.approx(0.38 * 25 + 25**2 / 16, abs=0.2)
    assert metrics["clearance_min"].value == pytest.approx(50 - metrics["stop_distance"].value, abs=0.05)
    assert metrics["impact"].value == 0
    assert np.isnan(metrics["impact_speed"].value)
    assert metrics["lateral_error_max"].value < 1e-6


def test_steering_passes_the_obstacle(scenario_run):
    metrics = scenario_run(NAME).summary.metrics
    assert metrics["decision"].value == 1
    assert metrics["distance_left"].value == 40 - 0.38 * 25
    assert metrics["last_point_to_steer"].value < 30.5 < metrics["last_point_to_brake"].value
    assert metrics["clearance_min"].value > 0.45 and metrics["road_margin_min"].value > 0.2
    assert metrics["lateral_error_max"].value < 0.02
    assert metrics["impact"].value == metrics["fallback_count"].value == 0
    assert np.isnan(metrics["stop_distance"].value)


def test_braking_and_steering_passes_it_nearer_and_slower(scenario_run):
    driven, steered = scenario_run(NAME, *BOTH), scenario_run(NAME).results
    metrics, results = driven.summary.metrics, driven.results
    assert metrics["decision"].value == 2
    left = metrics["distance_left"].value
    assert metrics["last_point_to_brake_and_steer"].value < left < metrics["last_point_to_steer"].value
    assert metrics["clearance_min"].value > 0.45 and metrics["impact"].value == 0
    assert metrics["lateral_error_max"].value < 0.05
    assert metrics["road_margin_min"].value > 0.1
    assert results["plant.velocity.x"][-1] < steered["plant.velocity.x"][-1] - 0.5
    assert results["mpc.wheel_torque.rl"].min() < 5 * steered["mpc.wheel_torque.rl"].min() < 0
    assert np.abs(results["plant.acceleration.y"]).max() > 1.1 * np.abs(steered["plant.acceleration.y"]).max()


def test_what_cannot_be_avoided_says_how_fast_it_was_hit(scenario_run):
    driven = driven_to_its_end(scenario_run, NEITHER)
    metrics, results = driven.summary.metrics, driven.results
    assert metrics["decision"].value == 3
    assert (metrics["impact"].value, metrics["clearance_min"].value) == (1, 0)
    assert (driven.summary.status, driven.summary.reason) == ("missed", "hit the obstacle (impact = 1, at most 0)")
    assert metrics["impact_speed"].value == pytest.approx(metrics["impact_speed_expected"].value, abs=0.6)
    assert metrics["impact_speed_expected"].value == pytest.approx(np.sqrt(25**2 - 16 * 15.5))
    nose = results["plant.position.x"] + 2.0
    touched = int(np.argmax(nose >= 27.0))
    assert metrics["impact_speed"].value == pytest.approx(results["plant.velocity.x"][touched], abs=0.2)
    assert results["plant.position.y"][touched] > 0.2, "the car steers although it will hit"


def test_a_slippery_road(scenario_run):
    metrics = scenario_run(NAME, *SLIPPERY).summary.metrics
    assert metrics["decision"].value == 1 and metrics["impact"].value == 0
    assert metrics["clearance_min"].value > 0.45 and metrics["lateral_error_max"].value < 0.05


@pytest.mark.parametrize("assignments", [(), BRAKE, BOTH, NEITHER, FAST, SLIPPERY])
def test_the_car_acts_when_it_has_reacted_and_not_before(scenario_run, assignments):
    metrics = driven_to_its_end(scenario_run, assignments).summary.metrics
    assert 0.3 <= metrics["first_action"].value < 0.4


@pytest.mark.parametrize("action", ["brake", "steer", "brake_and_steer"])
@pytest.mark.parametrize("speed", [15.0, 25.0, 35.0])
def test_each_action_works_just_before_its_last_point(scenario_run, action, speed):
    last = getattr(decide(Encounter(speed, 100.0), read()), action)
    distance = last + 0.38 * speed + 0.01
    metrics = scenario_run(NAME, f"scenario.speed={speed}", f"scenario.distance={distance}").summary.metrics
    if not (speed == 15 and action == "steer"):  # there the car would rather brake
        assert metrics["decision"].value == ("brake", "steer", "brake_and_steer").index(action)
    assert metrics["impact"].value == 0 and metrics["clearance_min"].value > 0.45
    assert metrics["road_margin_min"].value > 0.1


@pytest.mark.nightly
@pytest.mark.parametrize("action", ["brake", "steer", "brake_and_steer"])
@pytest.mark.parametrize(("speed", "friction"), [(15.0, 0.3), (35.0, 0.3), (22.0, 0.45), (31.0, 0.8)])
def test_each_action_works_on_slippery_roads(action, speed, friction, tmp_path):
    distance = getattr(decide(Encounter(speed, 100.0, friction), read()), action) + 0.38 * speed + 0.01
    values = {"speed": speed, "friction": friction, "distance": distance}
    given = [(f"scenario.{name}", str(value)) for name, value in values.items()]
    metrics = run(Request(load(NAME), tmp_path, given, stop_time=20.0)).summary.metrics
    assert metrics["decision"].value == ("brake", "steer", "brake_and_steer").index(action)
    assert metrics["impact"].value == 0 and metrics["clearance_min"].value > 0.45
    assert metrics["first_action"].value >= 0.3


@pytest.mark.parametrize("assignments", [(), BRAKE, BOTH, NEITHER])
def test_the_solvers_solve(scenario_run, assignments):
    metrics = driven_to_its_end(scenario_run, assignments).summary.metrics
    assert metrics["mpc_unsolved"].value == metrics["allocation_unsolved"].value == metrics["fallback_count"].value == 0


def test_where_there_is_no_room_the_last_points_to_steer_are_null_and_keep_their_unit(tmp_path):
    given = [("scenario.width", "7"), ("scenario.distance", "60")]
    summary = run(Request(load(NAME), tmp_path, given, stop_time=0.1)).summary
    assert summary.metrics["decision"].value == 0
    assert summary.metrics["last_point_to_steer"] == Metric(math.inf, "m")
    assert summary.data()["metrics"]["decision"] == "brake"
    assert summary.data()["metrics"]["mpc_unsolved"] == 0
    assert summary.data()["metrics"]["last_point_to_steer"] is None


def test_the_same_run_gives_the_same_bytes(tmp_path):
    for folder in ("a", "b"):
        assert run(Request(load(NAME), tmp_path / folder, [("scenario.distance", "25")])).summary.status == "missed"
    assert (tmp_path / "a" / "results.parquet").read_bytes() == (tmp_path / "b" / "results.parquet").read_bytes()


@pytest.mark.parametrize("assignments", [(), NEITHER])
def test_the_picture_is_drawn(scenario_run, assignments, tmp_path):
    driven_to_its_end(scenario_run, assignments).draw(tmp_path / "overview.png")
    assert (tmp_path / "overview.png").read_bytes().startswith(b"\x89PNG")


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("distance", "0", "scenario.distance = 0 m is outside its range 0.1 ... 300 m"),
        ("distance", "nan", "scenario.distance = 'nan' is not a finite number"),
        ("speed", "40", "scenario.speed = 40 m/s is outside its range 15 ... 35 m/s"),
        ("width", "7.5", "scenario.width = 7.5 m is outside its range 0.1 ... 7 m"),
        ("friction", "0", "scenario.friction = 0 is outside its range 0.3 ... 1"),
    ],
)
def test_what_cannot_be_met(name, value, sentence, tmp_path):
    with pytest.raises(CosimError) as error:
        run(Request(load(NAME), tmp_path, [(f"scenario.{name}", value)]))
    assert sentence in str(error.value)


def test_a_run_that_ends_before_the_obstacle_does_not_know(tmp_path):
    request = Request(load(NAME), tmp_path, [("scenario.distance", "50")], stop_time=1.0)
    metrics = run(request).summary.metrics
    assert all(np.isnan(metrics[name].value) for name in ("impact", "clearance_min", "stop_distance"))
    assert metrics["decision"].value == 0


@pytest.mark.parametrize(
    ("name", "value", "sentence"),
    [
        ("plant.initial.speed", "20", "plant.initial.speed = 20 is not what the car decides and plans for (25); set"),
        ("plant.initial.position.x", "3", "set scenario.distance instead"),
        ("plant.road_friction.rl", "0.5", "(1); set scenario.friction instead"),
        ("plant.road_friction.fl", "ice", "plant.road_friction.fl = ice is not"),
        ("reference.trajectory_file", "other.csv", "reference.trajectory_file is what the scenario plans"),
        ("reference.trajectory_file", "", "reference.trajectory_file is what the scenario plans"),
    ],
)
def test_what_contradicts_the_decision_is_refused(name, value, sentence, tmp_path):
    with pytest.raises(CosimError) as error:
        run(Request(load(NAME), tmp_path, [(name, value)]))
    assert sentence in str(error.value)


def test_what_follows_from_the_settings_may_be_set_by_hand(tmp_path):
    given = [("plant.initial.speed", "25"), ("plant.road_friction.rl", "1.0"), ("plant.initial.position.y", "0.1")]
    assert run(Request(load(NAME), tmp_path, given, stop_time=0.1)).summary.status == "ok"


def test_the_settings_are_within_the_table():
    settings, table = load(NAME).settings, read()
    limits = [(settings[name].minimum, settings[name].maximum) for name in ("speed", "friction")]
    assert limits == [(axis[0], axis[-1]) for axis in (table.speeds, table.frictions)]
    assert settings["width"].maximum == Surroundings().road


def test_car_and_obstacle_are_where_they_are(scenario_run):
    driven = scenario_run(NAME)
    planned = driven.plan.configured.prepared
    shape = car(driven.results, planned.surroundings)[0]
    np.testing.assert_allclose(shape, [[2, 0.84], [-2.3, 0.84], [-2.3, -0.84], [2, -0.84]])
    np.testing.assert_allclose(obstacle(planned), [[46.5, 1], [42, 1], [42, -1], [46.5, -1]])
    assert clearance(driven.results, planned)[0] == pytest.approx(40)


def test_separation_by_sampling():
    """Random rectangles against the least distance of many points on their edges, and of points within."""
    rng = np.random.default_rng(0)
    n = 300
    places = rng.uniform(-4, 4, (2, n)), rng.uniform(-4, 4, (2, n)), rng.uniform(-3, 3, (2, n))
    a, b = (footprint(*(p[i] for p in places), 2.0, 1.0, 1.5) for i in (0, 1))
    found = np.array([separation(a[i : i + 1], b[i])[0] for i in range(n)])
    s = np.linspace(0, 1, 60)[:, None]
    for i in range(n):
        edges = [np.vstack([(1 - s) * q[k] + s * q[k - 1] for k in range(4)]) for q in (a[i], b[i])]
        nearest = np.linalg.norm(edges[0][:, None] - edges[1][None], axis=-1).min()
        inside = any(_within(edges[j], (a, b)[1 - j][i]).any() for j in (0, 1))
        expected = 0.0 if inside else nearest
        assert found[i] == pytest.approx(expected, abs=0.06)
    assert 0.2 < np.mean(found == 0) < 0.9
    np.testing.assert_allclose(separation(a, b[0]), [separation(a[i : i + 1], b[0])[0] for i in range(n)])


def _within(points, polygon):
    edge = polygon - np.roll(polygon, -1, axis=0)
    away = points[:, None] - polygon[None]
    turn = edge[None, :, 0] * away[:, :, 1] - edge[None, :, 1] * away[:, :, 0]
    return (turn > 0).all(axis=1) | (turn < 0).all(axis=1)


def test_a_rectangle_beside_a_wide_one():
    wide = footprint(np.zeros(1), np.zeros(1), np.zeros(1), 10.0, 10.0, 2.0)[0]
    small = footprint(np.array([0.0, 0.0, 20.0, 13.0]), np.array([4.0, 1.2, 0.0, 5.0]), np.zeros(4), 1.0, 1.0, 2.0)
    np.testing.assert_allclose(separation(small, wide), [2.0, 0.0, 9.0, np.hypot(2, 3)])
