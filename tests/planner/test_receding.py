"""The receding horizon along whole roads: against the global optimum, other integrators and closed forms; fallbacks."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from test_receding_parts import loop, wide

from fmukit.direct import Direct
from fmus.planner import check, hocp
from fmus.planner.adaptive import planning
from fmus.planner.path_road import PathRoad
from fmus.planner.program import standing_ends
from fmus.planner.receding import COMPONENT, built_in, horizon, offline, road, run, search
from fmus.planner.receding.layout import LONG
from fmus.planner.receding.memory import BRAKED, ENDED, PLANNING
from fmus.planner.receding.offline import WholePlan
from tests.references.circuits import circuit, two_hairpins

ROWS = built_in.rows()
STRAIGHT = wide(np.column_stack([np.linspace(0, 300, 31), np.zeros(31)]))
PREVIEW = 3.0


@pytest.fixture(scope="module")
def tools() -> search.Tools:
    return offline.compiled()


@pytest.fixture(scope="module")
def drives(tools):
    made: dict[tuple, WholePlan] = {}

    def drive(**changes) -> WholePlan:
        key = tuple(changes.items())
        if key not in made:
            made[key] = offline.drive(tools, offline.parameters(named(changes)))
        return made[key]

    return drive


def named(changes: dict) -> dict:
    return {name.replace("__", "."): value for name, value in changes.items()}


NO_ELLIPSE = {"tyre__combined_slip": False}


@pytest.mark.parametrize("changes", [{}, NO_ELLIPSE], ids=["combined slip", "none"])
def test_close_to_the_global_optimum(drives, changes) -> None:
    """The whole road at once, with the same limits and gates, by the offline planner: at most 5 % faster."""
    p = offline.parameters(named(changes))
    whole = PathRoad(ROWS[:, :2], ROWS[:, 2:], p["road.clearance"])
    best = hocp.plan(offline.same_limits(p), whole, 69, standing_ends(15.0), hocp.PlanSettings(compile=False))
    found = drives(**changes)
    assert 1.0 <= found.final_time / best.final_time <= 1.05
    assert found.records[-1].failed == found.records[-1].fallbacks == 0
    assert len(found.records) == 14 and found.plan.phase == ENDED


def test_motion_is_continuous_and_real(drives) -> None:
    """Every interval, over all joints, replayed by SciPy from the node before: the states are those of the plan."""
    found = drives()
    vehicle = offline.same_limits(offline.parameters())
    assert check.replay(vehicle, found.nodes, restart=True) < 0.01
    from_joint = replace(found.nodes, x=found.nodes.x[:, :16], u=found.nodes.u[:, :15], T=found.nodes.T[:15])
    assert check.replay(vehicle, from_joint) < 0.05, "the first three problems without a restart"


def test_inputs_jump_no_more_at_joints_than_elsewhere(drives) -> None:
    jumps = np.abs(np.diff(drives().nodes.u, axis=1)) / np.array([[0.5], [5e3], [5e3]])
    joints = np.zeros(jumps.shape[1], dtype=bool)
    joints[4::5] = True
    assert jumps[:, joints].max() <= 1.2
    assert jumps[:, joints].mean() <= 2 * jumps[:, ~joints].mean()


def test_every_limit_holds_at_every_node(drives) -> None:
    p, found = offline.parameters(), drives()
    x, u = found.nodes.x[:, :70], found.nodes.u
    gates = PathRoad(ROWS[:, :2], ROWS[:, 2:], p["road.clearance"]).gates(69)
    away, (c, s) = x[:2].T - gates.frames[:, :2], (np.cos(gates.frames[:, 2]), np.sin(gates.frames[:, 2]))
    forward, side = c * away[:, 0] + s * away[:, 1], c * away[:, 1] - s * away[:, 0]
    np.testing.assert_allclose(forward, 0, atol=1e-4)
    assert (side >= gates.low - 1e-4).all() and (side <= gates.high + 1e-4).all()
    assert np.max(np.abs(side)) > 2.1, "the whole width is used"
    assert (np.abs(x[3]) <= 0.5 + 1e-6).all() and (np.abs(x[6]) <= 0.6 + 1e-6).all() and (x[2] >= 3).all()
    assert (np.abs(u[0]) <= 0.5 + 1e-6).all()
    assert u[1].min() >= -6e3 - 1e-2 and u[1].max() <= 1e-2 and u[2].min() >= -4e3 - 1e-2 and u[2].max() <= 5e3 + 1e-2
    assert max(record.violation for record in found.records) < 1e-6


def test_compiled_is_interpreted(drives) -> None:
    """The same path; bits may differ, since the C compiler orders arithmetic in its own way."""
    found = offline.drive(offline.compiled(), offline.parameters({"solver.timed": True}))
    assert found.final_time == pytest.approx(drives().final_time, abs=1e-4)
    assert min(record.time for record in found.records) > 0
    assert max(record.time for record in drives().records) == 0, "times are given on demand only"


def test_circle_is_driven_at_the_limit_of_grip(tools) -> None:
    """Round and round: the inner edge at v^2/R = the lateral grip of the axles, 0.7 g, a lap in 2 pi sqrt(R/a)."""
    p = offline.parameters({"road.closed": True, "initial.speed": 12.0})
    found = offline.drive(tools, p, wide(loop(60.0, 40)), most=30)
    assert found.records[-1].failed == 0 and found.plan.phase == PLANNING
    way = road.read(p, wide(loop(60.0, 40)))
    laps = [found.plan.times[k * way.last] for k in range(1, len(found.plan.times) // way.last + 1)]
    inner = 60.0 - 3.0 + 0.84
    assert laps[-1] - laps[-2] == pytest.approx(2 * np.pi * np.sqrt(inner / (0.7 * 9.81)), rel=0.05)
    assert found.plan.record.final_time == laps[-1]
    assert found.plan.x[-1, 4] > 2 * np.pi * (len(laps) - 0.5), "the yaw angle counts the turns"


@pytest.fixture(scope="module")
def long_tools() -> search.Tools:
    return offline.compiled(LONG)


CAUTIOUS = {
    "limit.front_brake": 3000.0,
    "limit.rear_brake": 1500.0,
    "limit.sideslip": 0.08,
    "tyre.friction": 0.8,
    "design.tyre.front.peak": 0.85 * 4560.4,
    "design.tyre.rear.peak": 0.85 * 3947.81,
}
"""Less than the planner has by its start values, as the scenario asks for."""


@pytest.mark.parametrize("changes", [{}, CAUTIOUS], ids=["start values", "cautious"])
def test_hairpins_after_a_straight(long_tools, changes) -> None:
    """Braking and lateral limits of the profile are those of the car: no problem fails, at most 5 % slower."""
    whole, p = two_hairpins(straight=300.0), offline.parameters(changes)
    found = offline.drive(long_tools, p, np.column_stack([whole.points, whole.widths]).tolist())
    best = planning.plan(offline.same_limits(p), whole, standing_ends(15.0))
    assert found.records[-1].failed == 0 and found.plan.phase == ENDED
    assert 0.99 <= found.final_time / best.final_time <= 1.05


@pytest.mark.parametrize("name", ["chicane", pytest.param("eight", marks=pytest.mark.nightly)])
@pytest.mark.parametrize("changes", [{}, CAUTIOUS], ids=["start values", "cautious"])
def test_lap_of_a_circuit(long_tools, name, changes) -> None:
    """From 12 m/s once around, against the optimum of the same lap as an open road."""
    road_, p = circuit(name, noise=0.03), offline.parameters({**changes, "road.closed": True, "initial.speed": 12.0})
    found = offline.drive(long_tools, p, np.column_stack([road_.points, road_.widths]).tolist(), lap=True)
    best = planning.plan(offline.same_limits(p), road_.unrolled(), standing_ends(12.0))
    assert found.records[-1].failed == 0 and 0.99 <= found.final_time / best.final_time <= 1.05
    fine = check.fine(offline.same_limits(p), found.nodes, 4)[1]
    assert road_.violation(fine[:2].T) < 0.25, "between the gates"


@pytest.mark.parametrize("deceleration", [4.0, 0.0])
def test_end_of_the_road(deceleration) -> None:
    car = Direct(COMPONENT, {"initial.speed": 20.0, "end.deceleration": deceleration}, table=np.array(STRAIGHT))
    speeds = []
    while (now := car.outputs())["reference.x"] < 300 and len(speeds) < 1000:
        car.sample()
        speeds.append(car["reference.speed"])
    assert car["plan.phase"] == ENDED and now["plan.final_time"] == pytest.approx(len(speeds) * 0.02, abs=0.05)
    for _ in range(700):
        car.sample()
        speeds.append(car["reference.speed"])
    assert speeds[-1] == (0.0 if deceleration else pytest.approx(car["preview[60].speed"]))
    fastest = max(speeds)
    if deceleration:
        assert car["reference.x"] == pytest.approx(300 + fastest**2 / 8, abs=0.6)
    assert abs(car["reference.y"]) < 0.1


def test_slow_end_is_kept(tools) -> None:
    p = offline.parameters({"end.speed": 12.0, "initial.speed": 20.0})
    found = offline.drive(tools, p, STRAIGHT)
    ending = found.plan.x[found.plan.x[:, 0] > 300 - 1e-6, 2]
    assert found.plan.phase == ENDED and found.records[-1].failed == 0
    assert len(ending) and ending.max() <= 12.0 + 1e-6 and found.plan.x[:, 2].max() > 25


def test_horizon_rule_and_sight(tools) -> None:
    """8 gates of 10 m with 10 % to spare: (v^2 - v_e^2)/(2 a_b) <= 72.7 m from one problem's start to its end."""
    short = offline.parameters({"road.sight": 80.0})
    way = road.read(short, STRAIGHT)
    bounds = horizon.fastest(8, short, way, 0)
    assert bounds[8] == 3.0, "where the sight ends the car must crawl"
    assert bounds[5] == pytest.approx(np.sqrt(9 + 10 * 80 / 1.1))
    seen, known = (
        offline.drive(tools, offline.parameters({"road.sight": sight}), STRAIGHT) for sight in (120.0, 1000.0)
    )
    assert seen.records[-1].failed == 0
    assert known.final_time < seen.final_time
    assert np.max(seen.plan.x[:15, 2]) < 32 < np.max(known.plan.x[:15, 2])


def failing(real, outcomes):
    """`search` whose results are declared unsolved where `outcomes`, one per call, say so; then as it is."""
    left = iter(outcomes)

    def search_(*arguments, **options):
        found = real(*arguments, **options)
        return replace(found, solved=found.solved and next(left, True))

    return search_


@pytest.mark.parametrize(
    ("outcomes", "failed", "fallbacks", "kind", "phase", "gates"),
    [
        ([True, False, True], 0, 0, 0, PLANNING, [5, 10, 15, 20]),
        ([True, *5 * [False]], 0, 0, 0, PLANNING, [5, 10, 15, 20]),
        ([True, *6 * [False]], 1, 1, horizon.TAIL, PLANNING, [5, 8, 13, 18]),
        ([True, *9 * [False]], 2, 2, horizon.SOFT, PLANNING, [5, 8, 13, 18]),
        (3 * [False], 1, 1, horizon.SOFT, PLANNING, [5, 10, 15, 20]),
        ([True, *10 * [False]], 2, 2, horizon.BRAKE, BRAKED, [5, 8, 8]),
        (4 * [False], 1, 1, horizon.BRAKE, BRAKED, [0]),
    ],
)
def test_fallbacks(tools, monkeypatch, outcomes, failed, fallbacks, kind, phase, gates) -> None:
    """From the tail, from a new guess, to slower ends, the rest of the last problem, softened, braking: all counted."""
    monkeypatch.setattr(horizon, "search", failing(search.search, outcomes))
    p = offline.parameters()
    way = road.read(p, [])
    plan, seen = run.start(p, way), []
    while len(seen) < 4 and plan.phase == PLANNING:
        plan = horizon.extended(tools, p, way, plan)
        seen.append(plan.gate)
    record = plan.record
    assert (record.failed, record.fallbacks, record.fallback, plan.phase) == (failed, fallbacks, kind, phase)
    assert seen == gates
    assert (np.diff(plan.times) > 0).all() and np.isfinite(plan.x).all()


def test_impossible_start_is_softened_or_braked(tools) -> None:
    """At 45 m/s, 40 m before a hairpin of 15 m radius: no plan, but always a finite trajectory, and it is counted."""
    angle = np.linspace(0, np.pi, 12)
    hairpin = np.column_stack([40 + 15 * np.sin(angle), 15 * (1 - np.cos(angle))])
    rows = np.array(wide(np.vstack([[[0, 0], [10, 0], [20, 0], [30, 0]], hairpin])))
    car = Direct(COMPONENT, {"initial.speed": 45.0}, table=rows)
    seen = []
    for _ in range(700):
        car.sample()
        seen.append(car.outputs())
    assert car["problem.failed"] >= 1 and car["fallback.count"] >= 1 and car["fallback.kind"] in (2.0, 3.0)
    assert all(np.isfinite(list(now.values())).all() for now in seen)
    assert max(-now["reference.acceleration"] for now in seen) > 4
    assert seen[-1]["reference.speed"] == 0.0


def test_softened_problem_leaves_the_corridor_as_little_as_it_can(tools) -> None:
    """Started 1 m outside: unsolved as it is, softened it returns within a few gates, and says how much it left."""
    p = offline.parameters()
    way = road.read(p, [])
    plan = run.start(p, way)
    x = plan.x.copy()
    x[0, 2], x[0, 4] = 25.0, 0.2
    x[0, 1] = 2.0
    ahead = horizon.problem(tools.horizon, p, way, replace(plan, x=x))
    first = horizon.guess(ahead, horizon.NO_TAIL, 0.0)
    hard, soft = (search.search(tools, p, ahead, first, soft=soft) for soft in (False, True))
    assert not hard.solved and hard.status < 0 and hard.slack == 0
    assert soft.solved and 0.1 < soft.slack < 5
    assert abs(soft.nodes.x[-1, 1]) <= 2.16 + 0.05


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"initial.lateral": 2.5}, r"initial\.lateral = 2\.5 m leaves the road, .* \[-2\.16, 2\.16\] m; start closer"),
        ({"initial.speed": 70.0}, r"initial\.speed = 70 m/s is outside \[3, limit\.speed = 60\]"),
        ({"horizon.accept": 9.0}, r"horizon\.accept = 9 must be a whole number up to 8"),
        ({"horizon.accept": 2.5}, r"horizon\.accept = 2\.5 must be a whole number"),
        ({"road.spacing": 1.5}, r"a plan may need 1\d\d nodes, but there is room for 128; give a larger road\.spacing"),
        ({"road.sight": 60.0}, r"road\.sight = 60 m is too short for a horizon of 80 m"),
        ({"road.clearance": 3.5}, r"narrower than the car by 1\.00 m .* along the road"),
    ],
)
def test_parameters_that_do_not_go_together(changes, message) -> None:
    with pytest.raises(ValueError, match=message):
        Direct(COMPONENT, changes)


@pytest.fixture(scope="module")
def played():
    """(times, samples by name) of the bus over the whole built-in road."""
    car = Direct(COMPONENT)
    seen = [car.outputs()]
    for _ in range(1500):
        car.sample()
        seen.append(car.outputs())
    names = seen[0].keys()
    return 0.02 * np.arange(1500), {name: np.array([now[name] for now in seen[1:]]) for name in names}


def test_bus_is_one_motion_over_all_joints(played) -> None:
    """Numerical derivatives of what is sent every 20 ms: no jump of position, course or speed anywhere."""
    _, now = played
    now = {name: now[f"reference.{name}"] for name in ("x", "y", "course", "speed", "acceleration", "curvature")}
    step = 0.02
    assert np.abs(np.diff(now["speed"])).max() < 12 * step and np.abs(np.diff(now["course"])).max() < 2 * step
    along = np.hypot(np.diff(now["x"]), np.diff(now["y"])) / step
    np.testing.assert_allclose(along, 0.5 * (now["speed"][1:] + now["speed"][:-1]), atol=0.03)
    direction = np.unwrap(np.arctan2(np.diff(now["y"]), np.diff(now["x"])))
    np.testing.assert_allclose(direction, 0.5 * (now["course"][1:] + now["course"][:-1]), atol=5e-3)
    gained = np.cumsum(0.5 * (now["acceleration"][1:] + now["acceleration"][:-1]) * step)
    np.testing.assert_allclose(now["speed"][1:] - now["speed"][0], gained, atol=0.25)
    turned = np.diff(now["course"]) / step
    middle = 0.5 * (now["speed"] * now["curvature"])[1:] + 0.5 * (now["speed"] * now["curvature"])[:-1]
    assert np.mean(np.abs(turned - middle) > 0.05) < 0.02, "but where inputs jump within the interval"


def test_preview_is_what_comes(played) -> None:
    _, now = played
    for k in (1, 20, 60):
        later = round(k * 0.05 / 0.02)
        if k % 2 == 0:
            np.testing.assert_allclose(now[f"preview[{k}].x"][:-later], now["reference.x"][later:], atol=1e-6)
            np.testing.assert_allclose(now[f"preview[{k}].speed"][:-later], now["reference.speed"][later:], atol=1e-6)
    planning = now["plan.phase"] == PLANNING
    assert (now["plan.end_time"] - played[0] >= PREVIEW + 0.02)[planning].all()
    assert now["problem.count"][-1] == 14 and now["problem.failed"][-1] == 0
    assert np.max(np.diff(now["problem.count"])) == 1, "one local problem at a time"


def test_samples_are_pure(tools) -> None:
    """Two cars by turns, on different roads, give the bits of each alone, and samples may be repeated."""
    both = [Direct(COMPONENT, {"initial.speed": speed}) for speed in (15.0, 20.0)]
    alone = [Direct(COMPONENT, {"initial.speed": speed}) for speed in (15.0, 20.0)]
    for _ in range(120):
        for car in both:
            car.sample()
    for car in alone:
        for _ in range(120):
            car.sample()
    for together, single in zip(both, alone, strict=True):
        np.testing.assert_array_equal(together.y, single.y)
        np.testing.assert_array_equal(together.x, single.x)


def test_slow_sampling_is_covered(tools) -> None:
    """Every 200 ms, the preview still lies within the plan."""
    car = Direct(COMPONENT, {"sample_period": 0.2})
    for k in range(60):
        car.sample(0.2)
        assert car["plan.end_time"] >= 0.2 * k + PREVIEW + 0.2


def test_replanning_from_the_estimate(tools) -> None:
    """A car pushed 1 m aside: the reference begins anew where it is; without the switch the plan stays."""
    for enabled in (True, False):
        car = Direct(COMPONENT, {"replan.from_estimate": enabled})
        for k in range(120):
            car.set(
                {
                    "estimate.position.x": car["reference.x"],
                    "estimate.position.y": car["reference.y"] + (1.0 if k == 100 else 0.0),
                    "estimate.yaw": car["reference.course"],
                    "estimate.velocity.x": car["reference.speed"],
                    "estimate.yaw_rate": car["reference.yaw_rate"],
                }
            )
            expected = car["reference.x"], car["reference.y"] + (1.0 if k == 100 and enabled else 0.0)
            car.sample()
            if k == 100:
                assert np.hypot(car["reference.x"] - expected[0], car["reference.y"] - expected[1]) < 0.75
                assert abs(car["reference.y"] - (1.0 if enabled else 0.0)) < 0.05
        assert car["replan.count"] == enabled and car["problem.failed"] == 0
        assert car["plan.end_time"] >= 119 * 0.02 + PREVIEW
