"""Meshes that follow road and plan: their geometry, flying laps, and plans where a mesh of equal parts has none."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.spatial import cKDTree
from test_infeasible import hairpin

from fmus.cars.published import single_track
from fmus.planner.adaptive import planning
from fmus.planner.adaptive.line import smooth_line
from fmus.planner.adaptive.mesh import mesh
from fmus.planner.adaptive.speed import BRAKE, GAIN, LATERAL, profile
from fmus.planner.check import motion
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Plan, PlanSettings
from fmus.planner.path_road import PathRoad
from fmus.planner.planned_cars import CARS
from fmus.planner.program import standing_ends
from fmus.planner.vehicle import two_wheel_drive
from tests.references.circuits import circuit, two_hairpins

CAR = two_wheel_drive(single_track())


def circle(radius: float, noise: float = 0.0) -> PathRoad:
    count = round(2 * np.pi * radius / 5)
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    points = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    points += noise * np.random.default_rng(2).standard_normal(points.shape)
    return PathRoad(points, np.tile([3.0, 4.0], (count, 1)), clearance=1.0, closed=True)


def driven(plan: Plan, per_interval: int = 10) -> np.ndarray:
    """(n, 2) points of the plan by an independent integrator, every interval from its own node."""
    points = []
    for k, T in enumerate(plan.nodes.T):
        at = np.linspace(0, T, per_interval, endpoint=False)
        arguments = plan.vehicle, plan.nodes.u[:, k]
        found = solve_ivp(motion, (0, T), plan.nodes.x[:, k], t_eval=at, rtol=1e-8, atol=1e-8, args=arguments)
        points.append(found.y[:2].T)
    return np.vstack(points)


def outside(road: PathRoad, points: np.ndarray) -> float:
    """Largest distance [m] beyond the edges, taken from a dense set of discs: the road is the union of all of them."""
    curve, s, widths = road.curve()
    at = np.linspace(s[0], s[-1], 200 * len(s))
    slope = curve(at, 1)
    normal = np.column_stack([-slope[:, 1], slope[:, 0]]) / np.hypot(*slope.T)[:, None]
    far, near = cKDTree(curve(at)).query(points)
    left = np.sum((points - curve(at)[near]) * normal[near], axis=1) > 0
    room = np.where(left, *(np.interp(at[near], s, widths[:, j]) - road.clearance for j in (0, 1)))
    return float((far - room).max())


def test_line_of_a_circle_is_the_circle() -> None:
    line = smooth_line(circle(50.0))
    radius = np.hypot(*line.points.T)
    np.testing.assert_allclose(radius, radius.mean(), atol=1e-3)
    assert radius.mean() == pytest.approx(50, abs=0.02), "smoothing pulls a circle in by lambda^4/R^3"
    np.testing.assert_allclose(line.curvature, 1 / 50, rtol=1e-2)
    np.testing.assert_allclose(line.left + (50 - radius), 2.0, atol=0.02)
    np.testing.assert_allclose(line.right - (50 - radius), 3.0, atol=0.02)


def test_line_is_smooth_where_the_road_is_not_and_has_its_edges() -> None:
    road = circle(80.0, noise=0.05)
    line, (curve, s, _) = smooth_line(road), road.curve()
    at = np.linspace(s[0], s[-1], 4000)
    slope, bend = curve(at, 1), curve(at, 2)
    rough = (slope[:, 0] * bend[:, 1] - slope[:, 1] * bend[:, 0]) / np.hypot(*slope.T) ** 3
    assert line.curvature.std() < 0.25 * rough.std()
    for points, side in zip(line.edges(), (0, 1), strict=True):
        assert np.abs(road.outside(points)[:, side]).max() < 0.01


def test_widths_are_measured_on_the_own_branch_where_a_road_crosses_itself() -> None:
    road = circuit("eight")
    line = smooth_line(road)
    assert min(line.left.min(), line.right.min()) > 2.0 and max(line.left.max(), line.right.max()) < 6.5


def test_profile_of_straights_and_a_curve() -> None:
    """On a straight before a curve v^2 = v_c^2 + 2 a s; in the curve v^2 kappa = a_y."""
    s = np.arange(0, 400.5, 0.5)
    kappa = np.where((s > 200) & (s < 250), 0.02, 0.0)
    v = profile(s, kappa, 60.0, 10.0, closed=False)
    corner = np.sqrt(LATERAL / 0.02)
    assert v[0] == 10 and v[450] == pytest.approx(corner)
    assert v[380] ** 2 == pytest.approx(corner**2 + 2 * BRAKE * 10.25, rel=0.01)
    assert v[20] ** 2 == pytest.approx(100 + 2 * GAIN * 10, rel=0.01)


def test_spacing_keeps_the_integration_stable_and_changes_gently() -> None:
    line = smooth_line(circuit("chicane"))
    v = profile(line.s, line.curvature, 60.0, closed=True)
    made = mesh(line, v)
    ds, fast = np.diff(made.at), np.interp(made.at, line.s, v)
    assert (ds <= 2 * np.maximum(fast[:-1], fast[1:]) ** 2 / 60 * 1.05 + 1.0).all()
    assert made.intervals % 50 == 0 and ds.min() < 0.5 * ds.max()
    assert np.abs(np.diff(ds)).max() <= 0.15 * ds.max() + 1e-6
    finer = mesh(line, v, 2.0)
    assert finer.intervals >= 1.5 * made.intervals


@pytest.mark.parametrize(("name", "backwards"), [("chicane", False), ("chicane", True), ("eight", False)])
def test_flying_lap_stays_on_the_road_and_repeats(name: str, backwards: bool) -> None:
    road = circuit(name, noise=0.03, backwards=backwards)
    found = planning.plan(CAR, road)
    first, last = found.nodes.x[:, 0], found.nodes.x[:, -1]
    np.testing.assert_allclose(last[[0, 1, 2, 3, 5, 6]], first[[0, 1, 2, 3, 5, 6]], atol=1e-6)
    assert np.abs(np.sin((last[4] - first[4]) / 2)) < 1e-6
    assert found.status == "Solve_Succeeded" and found.residual < 1e-7
    assert outside(road, driven(found)) <= 0.02 and found.violation <= 0.02
    assert found.replay_error(restart=True) < 0.005


def test_flying_lap_is_the_middle_one_of_three() -> None:
    """Three laps as one open road need no periodic condition: the middle one hardly knows of the ends."""
    road = circuit("chicane")
    lap = planning.plan(CAR, road)
    points, widths = np.vstack([road.points] * 3), np.vstack([road.widths] * 3)
    three = planning.plan(CAR, PathRoad(points, widths), standing_ends(20.0))
    x, y = road.points[0]
    heading = np.arctan2(*(road.points[1] - road.points[-1])[::-1])
    ahead = np.cos(heading) * (three.nodes.x[0] - x) + np.sin(heading) * (three.nodes.x[1] - y)
    near = np.hypot(three.nodes.x[0] - x, three.nodes.x[1] - y) < 30
    crossed = [k for k in range(1, len(ahead)) if ahead[k - 1] < 0 <= ahead[k] and near[k]]
    times = [np.interp(0, ahead[k - 1 : k + 1], three.nodes.times[k - 1 : k + 1]) for k in crossed]
    assert times[1] - times[0] == pytest.approx(lap.final_time, rel=5e-3)


@pytest.mark.nightly
@pytest.mark.parametrize("name", ["chicane", "eight"])
def test_flying_lap_of_the_multibody_car(name: str) -> None:
    road = circuit(name, noise=0.03)
    found = planning.plan(CARS["vehicle16dof"]().vehicle, road)
    assert outside(road, driven(found)) <= 0.02
    assert found.final_time > planning.plan(CAR, road).final_time, "with a fifth less grip"


@pytest.mark.parametrize("least", [72, 100])
def test_hairpins_after_a_straight_have_a_plan_on_any_mesh(least: int) -> None:
    road = two_hairpins()
    found = planning.plan(CAR, road, standing_ends(15.0), least=least)
    assert len(found.nodes.T) >= least
    assert outside(road, driven(found)) <= 0.02


def test_a_search_that_fails_is_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    """With too few iterations for the first mesh only, the plan is that of the finer mesh."""
    road, calls = two_hairpins(), []
    plain = planning._Task.found

    def failing(self, made, before=None):
        calls.append(made.intervals)
        short = replace(self, settings=replace(self.settings, max_iterations=5)) if len(calls) == 1 else self
        return plain(short, made, before)

    monkeypatch.setattr(planning._Task, "found", failing)
    found = planning.plan(CAR, road, standing_ends(15.0))
    assert len(calls) == 3 and len(found.nodes.T) == calls[2] and found.residual < 1e-6


def test_only_what_was_shown_is_blamed() -> None:
    """A hairpin near the car's smallest circle: with a wider road there is a plan, so the width may be named."""
    with pytest.raises(PlanningError, match=r"it breaks near x = .* wider to both sides"):
        planning.plan(CAR, hairpin(3.2, 1.5), settings=PlanSettings(max_iterations=200))
    few = PlanSettings(max_iterations=3)
    with pytest.raises(PlanningError, match="nothing shows that the road is at fault"):
        planning.plan(CAR, two_hairpins(), settings=few)


def test_folded_edges_are_refused() -> None:
    with pytest.raises(PlanningError, match=r"turns too sharply for its width near x = .* m along it"):
        planning.plan(CAR, PathRoad(hairpin(4.0, 2.0).points, np.full((len(hairpin(4.0, 2.0).points), 2), 14.0)))
