"""Parts of the receding-horizon planner: spline, gates, speed profile, memory, motion after the plan."""

from __future__ import annotations

from dataclasses import astuple
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from fmus.planner.path_road import PathRoad
from fmus.planner.receding import built_in, bus, limits, memory, offline, replan, road, run, speed
from fmus.planner.receding.centre_line import spline
from fmus.planner.receding.memory import Record, RollingPlan, Tail
from fmus.planner.road_file import read_road

RNG = np.random.default_rng(4)
BEND = np.array([[0.0, 0.0], [9.0, 1.0], [21.0, 2.0], [30.0, 9.0], [33.0, 20.0], [30.0, 33.0]])


def loop(radius: float = 40.0, n: int = 24) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, n, endpoint=False)
    return np.column_stack([radius * np.sin(angle), radius * (1 - np.cos(angle))])


def wide(points: np.ndarray, half: float = 3.0) -> list[list[float]]:
    return np.column_stack([points, np.full((len(points), 2), half)]).tolist()


@pytest.mark.parametrize(("points", "closed"), [(BEND, False), (BEND[:4], False), (BEND, True), (loop(), True)])
def test_spline_is_that_of_scipy(points, closed) -> None:
    ours = spline(points, closed)
    theirs = CubicSpline(ours.s, ours.points, bc_type="periodic" if closed else "not-a-knot")
    at = np.linspace(0, ours.s[-1], 301)
    np.testing.assert_allclose(ours(at), theirs(at), atol=1e-11)
    np.testing.assert_allclose(ours.slope(at), theirs(at, 1), atol=1e-11)


@pytest.mark.parametrize(("points", "closed"), [(built_in.rows()[:, :2], False), (loop(), True)])
def test_gates_are_across_the_road_of_the_offline_planner(points, closed) -> None:
    """On the same line, in the same directions, and narrower by no more than the bow of an edge between gates."""
    p = offline.parameters({"road.closed": closed})
    ours = road.read(p, wide(points))
    theirs = PathRoad(points, np.full((len(points), 2), 3.0), p["road.clearance"], closed).gates(40000)
    length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(theirs.frames[:, :2], axis=0).T))])
    for column in range(3):
        expected = np.interp(ours.at, length, theirs.frames[:, column])
        np.testing.assert_allclose(ours.frames[:, column], expected, atol=2e-3)
    pairs = ((ours.high, theirs.high), (-ours.low, -theirs.low))
    narrower = np.column_stack([np.interp(ours.at, length, edge) - own for own, edge in pairs])
    assert narrower.min() > -1e-9 and 0.01 < narrower.max() <= 0.3 and narrower.min(axis=1).max() == 0
    assert np.diff(ours.at).max() <= 10.1 and np.diff(ours.at).min() >= 4


def test_built_in_road_has_even_gates_of_the_full_width() -> None:
    ours = road.read(offline.parameters(), [])
    theirs = PathRoad(built_in.rows()[:, :2], built_in.rows()[:, 2:], 0.84).gates(69)
    np.testing.assert_allclose(ours.frames, theirs.frames, atol=1e-9)
    np.testing.assert_allclose(ours.low, theirs.low)
    np.testing.assert_allclose(ours.high, theirs.high)
    assert ours.horizon == 8 and road.read(offline.parameters(), built_in.rows().tolist()).horizon == 24


def test_gates_draw_together_where_the_car_is_slow() -> None:
    """v^2 = a_y R in a hairpin of 9 m: the integration over a gate must stay stable, 2.78 >= damping step / v."""
    angle = np.linspace(0, np.pi, 12)
    hairpin = np.column_stack([100 + 9 * np.sin(angle), 9 * (1 - np.cos(angle))])
    back = np.column_stack([np.linspace(95, 0, 20), np.full(20, 18.0)])
    rows = wide(np.vstack([np.column_stack([np.linspace(0, 95, 20), np.zeros(20)]), hairpin, back]), 2.0)
    way = road.read(offline.parameters(), rows)
    spacing, middle = np.diff(way.at), 0.5 * (way.at[1:] + way.at[:-1])
    slow = np.abs(middle - way.at[-1] / 2) < 10
    assert spacing[slow].max() < 6.5 * 9 / 11 and spacing[:5].min() > 9
    assert np.abs(np.diff(spacing) / spacing[1:]).max() < 0.2


def test_limits_are_those_of_the_car_or_less() -> None:
    """Peaks of 8508 N and brakes of 10 kN on 1239 kg allow more than is asked for by default; smaller ones do not."""
    p = offline.parameters()
    assert (limits.lateral(p), limits.braking(p)) == (6.5, 5.0)
    weak = p | {"limit.front_brake": 3000.0, "limit.rear_brake": 1500.0, "design.tyre.front.peak": 3000.0}
    assert limits.braking(weak) == pytest.approx(0.9 * 4500 / 1239)
    assert limits.lateral(weak) == pytest.approx(0.95 * (3000 + p["design.tyre.rear.peak"]) / 1239)
    icy = p | {"tyre.friction": 0.3}
    assert limits.braking(icy) == pytest.approx(0.9 * 0.3 * 9.81)
    assert limits.braking(icy | {"tyre.combined_slip": False}) == 5.0


def test_built_in_road() -> None:
    """690 m with the radii it is said to have."""
    ours = road.read(offline.parameters({"road.spacing": 2.0}), [])
    assert ours.at[-1] == pytest.approx(690.0, abs=0.01)
    tightest = [np.max(np.abs(ours.curvature[round(a / 2) : round(b / 2)])) for a, b in ((110, 150), (255, 285))]
    np.testing.assert_allclose(1 / np.array(tightest), [60.0, 25.0], rtol=0.01)
    assert 1 / ours.curvature.max() == pytest.approx(40.0, rel=0.01)


def test_shipped_file_is_the_built_in_road() -> None:
    file = road.__file__.replace("road.py", "built_in.csv")
    np.testing.assert_allclose(np.loadtxt(file, delimiter=",", skiprows=1), built_in.rows(), atol=1e-6)


def test_gates_go_on_beyond_the_end_and_around() -> None:
    straight = road.read(offline.parameters(), wide(np.column_stack([np.linspace(0, 100, 11), np.zeros(11)])))
    beyond = straight.gates(8, 6)
    np.testing.assert_allclose(beyond.frames[:, 0], [80, 90, 100, 110, 120, 130], atol=1e-9)
    ring = road.read(offline.parameters({"road.closed": True}), wide(loop()))
    once, twice = ring.gates(0, 5), ring.gates(ring.last, 5)
    np.testing.assert_allclose(twice.frames, once.frames + np.array([0, 0, 2 * np.pi]), atol=1e-9)
    before = ring.gates(-2, 4)
    np.testing.assert_allclose(np.diff(before.frames[:, 2]), ring.turn / ring.last, rtol=0.05)
    np.testing.assert_allclose(ring.curvature, 1 / 40, rtol=2e-3)


def test_car_behind_an_open_road_begins_at_its_first_gate() -> None:
    p = offline.parameters()
    way = road.read(p, [])
    plan = run.start(p, way)
    assert replan.gate_before(way, plan, plan.x[0] - np.array([20.0, 0, 0, 0, 0, 0, 0])) == 0


def test_road_survives_its_numbers() -> None:
    ring = road.read(offline.parameters({"road.closed": True}), wide(loop()))
    back = road.from_numbers(road.to_numbers(ring))
    for name in ("frames", "low", "high", "curvature", "at", "closed", "turn", "horizon"):
        np.testing.assert_array_equal(getattr(back, name), getattr(ring, name))


def test_speed_profile_is_the_closed_form() -> None:
    straight = np.zeros(12)
    left = 10.0 * np.arange(11, -1, -1)
    np.testing.assert_allclose(speed.profile(straight, 10.0, 6.5, 5.0, 8.0), np.sqrt(64 + 2 * 5 * left))
    circle = np.full(20, -1 / 30)
    np.testing.assert_allclose(speed.profile(circle, 10.0, 6.5, 5.0, 60.0), np.sqrt(6.5 * 30))
    assert speed.profile(straight, 10.0, 6.5, 5.0, 0.0)[-1] == speed.SLOWEST
    assert speed.within_horizon(5.0, 88.0, 5.0) == pytest.approx(np.sqrt(25 + 2 * 5 * 80))


def test_braking_into_a_curve_stays_within_the_ellipse() -> None:
    """The profile against v' = a_b sqrt(1 - (v^2 kappa/a_y)^2)/v, integrated backwards with a fine step."""
    s = np.linspace(0, 60, 2401)
    kappa = np.interp(s, [0, 60], [0, 1 / 25])
    v = speed.profile(kappa, s[1], 6.5, 5.0, 9.0)

    def rate(left: float, square: np.ndarray) -> np.ndarray:
        used = square * np.interp(60 - left, s, kappa) / 6.5
        return 10.0 * np.sqrt(np.maximum(1 - used**2, 0))

    exact = solve_ivp(rate, (0, 60), [81.0], rtol=1e-9, dense_output=True).sol(60 - s)[0]
    np.testing.assert_allclose(v, np.sqrt(exact), rtol=2e-3)


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-0.1, 0.1), min_size=2, max_size=40), st.floats(3, 60), st.floats(1, 20))
def test_speed_profile_can_be_braked_along(curvature, end, spacing) -> None:
    v = speed.profile(np.array(curvature), spacing, 6.5, 5.0, end)
    assert (v >= speed.SLOWEST).all()
    slow = np.maximum(v[1:], speed.SLOWEST)
    assert (v[:-1] ** 2 <= slow**2 + 2 * 5.0 * spacing + 1e-9).all()
    bounded = v > speed.SLOWEST
    assert (v[bounded] ** 2 * np.abs(curvature)[bounded] <= 6.5 + 1e-9).all()


def some_plan(n: int = 9, k: int = 3) -> RollingPlan:
    tail = Tail(RNG.normal(size=(k, 7)), RNG.normal(size=(k, 3)), RNG.uniform(0.1, 1, k))
    record = Record(5, 1, 2, 1, 3, -2, 17, 0.25, 1e-7, 0.5, 12.5)
    times = np.cumsum(RNG.uniform(0.1, 1, n))
    return RollingPlan(times, RNG.normal(size=(n, 7)), RNG.normal(size=(n, 3)), 14, 2, -0.01, tail, record)


def test_memory_keeps_everything() -> None:
    plan = some_plan()
    numbers = memory.to_numbers(plan, 8)
    assert len(numbers) == memory.size(8)
    back = memory.from_numbers(numbers.tolist(), 8)
    assert astuple(back.record) == astuple(plan.record) and isinstance(back.record.count, int)
    assert (back.gate, back.phase, back.bend) == (plan.gate, plan.phase, plan.bend)
    for ours, theirs in ((back, plan), (back.tail, plan.tail)):
        for name in ("times", "x", "u", "T"):
            if hasattr(ours, name):
                np.testing.assert_array_equal(getattr(ours, name), getattr(theirs, name))


def test_memory_has_an_end() -> None:
    with pytest.raises(ValueError, match=r"the plan has 129 nodes, but there is room for 128; give a larger road"):
        memory.to_numbers(some_plan(129), 8)


def test_plan_forgets_what_is_past() -> None:
    plan = some_plan()
    middle = 0.5 * (plan.times[3] + plan.times[4])
    assert plan.since(middle).times[0] == plan.times[3]
    assert plan.since(plan.times[4]).times[0] == plan.times[4]
    assert len(plan.since(1e9).times) == 1 and len(plan.since(-1.0).times) == len(plan.times)


@pytest.mark.parametrize(("rate", "bend"), [(5.0, 0.02), (5.0, 0.0), (0.0, -0.01), (4.0, -0.05)])
def test_onward_is_the_integrated_motion(rate, bend) -> None:
    t = np.linspace(0, 5, 61)
    found = bus.onward(np.array([3.0, -2.0, 0.7, 14.0]), rate, bend, t)

    def motion(_: float, z: np.ndarray) -> list[float]:
        v = max(z[3], 0.0)
        return [v * np.cos(z[2]), v * np.sin(z[2]), v * bend, -rate if z[3] > 0 else 0.0]

    exact = solve_ivp(motion, (0, 5), [3.0, -2.0, 0.7, 14.0], t_eval=t, rtol=1e-10, atol=1e-10, max_step=0.01).y.T
    np.testing.assert_allclose(found[:, :4], exact, atol=1e-3)
    moving = found[:, 3] > 0
    np.testing.assert_array_equal(found[moving, 4], -rate if rate else 0.0)
    assert (found[~moving, 4] == 0).all() and (found[:, 5] == bend).all()


@pytest.mark.parametrize(
    ("rows", "change", "message"),
    [
        (wide(BEND[:3]), {}, r"the road has 3 points; give at least 4"),
        (wide(BEND, 0.5), {}, r"narrower than the car by 0\.68 m near x = .* m along the road; widen it"),
        (wide(np.vstack([BEND[:2], BEND[1:]])), {}, r"same point twice in a row, row 2; drop one"),
        (wide(np.vstack([loop(), [[4.0, 0.2]]])), {"road.closed": True}, r"past its start: row 25, .* 4\.0 m"),
        (wide(np.vstack([loop(), loop()[1:4] + 0.1])), {"road.closed": True}, r"past its start: row 27"),
        (wide(BEND, -1.0), {}, r"negative width in row 1"),
        (wide(BEND, 60.0), {}, r"turns too sharply for its width near .* m along it"),
        (wide(np.column_stack([np.linspace(0, 9e4, 90), np.zeros(90)])), {}, r"has 9001 gates 10 m apart, but .* 2000"),
    ],
)
def test_roads_that_cannot_be_used(rows, change, message) -> None:
    with pytest.raises(ValueError, match=message):
        road.read(offline.parameters(change), rows)


def test_narrow_place_is_named(tmp_path) -> None:
    rows = built_in.rows()
    rows[60:64, 2:] = 0.7
    with pytest.raises(ValueError, match=r"narrower than the car by 0\.28 m near .*, 30\d m along the road"):
        road.read(offline.parameters(), rows.tolist())


def test_shipped_file_is_a_road_for_the_offline_planner(tmp_path) -> None:

    found = read_road(Path(road.__file__).with_name("built_in.csv"))
    assert len(found.points) == 139
