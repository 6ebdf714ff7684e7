"""Time-optimal plans against reference values, closed forms and other integrators."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from time import time

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from fmukit.compiling import compiler
from fmukit.direct import Direct
from fmukit.errors import BuildError
from fmus.cars.published import single_track
from fmus.controllers.reference import COMPONENT
from fmus.controllers.reference.interface import COLUMNS
from fmus.planner import trajectory
from fmus.planner.check import fine
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import Grid, Plan, PlanSettings, plan
from fmus.planner.path_road import PathRoad
from fmus.planner.program import Ends, standing_ends
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from tests.references.gear_shift import gear_shift_car
from tests.references.gerdts_form import gerdts
from tests.references.refinement import refine

CAR = two_wheel_drive(single_track())
INTERPRETED = PlanSettings(compile=False)
FREE = np.nan


@pytest.fixture(scope="module")
def gate_80() -> Plan:
    return plan(CAR, double_lane_change(), 80, settings=INTERPRETED)


def test_gate_grid(gate_80: Plan) -> None:
    assert gate_80.status == "Solve_Succeeded" and gate_80.how == "interpreted"
    assert 0 <= gate_80.residual < 1e-8 and gate_80.solve_time > 0
    assert gate_80.final_time == pytest.approx(7.1868, abs=5e-4)
    assert gate_80.nodes.x[2, -1] == pytest.approx(36.9, abs=0.05)
    assert gate_80.iterations < 60
    assert 0 < gate_80.violation < 0.08, "between the nodes the road is left by a little, and this is reported"


def test_time_grid() -> None:
    found = plan(CAR, double_lane_change(), 80, settings=replace(INTERPRETED, grid="time"))
    assert found.final_time == pytest.approx(7.1870, abs=5e-4)
    np.testing.assert_allclose(found.nodes.T, found.final_time / 80, rtol=1e-12)


@pytest.mark.nightly
@pytest.mark.parametrize(("grid", "seconds"), [("gate", 7.1880), ("time", 7.1882)])
def test_finer_mesh(grid: Grid, seconds: float) -> None:
    found = plan(CAR, double_lane_change(), 160, settings=PlanSettings(grid=grid))
    assert found.final_time == pytest.approx(seconds, abs=5e-4)
    assert found.violation < 0.03


def gear_shift(m: int, substeps: int) -> Plan:
    road = double_lane_change(1.0, 0.75, 1.5, "cubic")
    settings = PlanSettings(grid="time", substeps=substeps, smoothing=0.0, compile=False)
    return plan(gear_shift_car(single_track()), road, m, settings=settings)


@pytest.mark.parametrize(
    ("m", "substeps", "seconds"), [(10, 16, 6.7983), (20, 8, 6.7789), (40, 4, 6.7863), (80, 2, 6.7887)]
)
def test_published_gear_shift_drive(m: int, substeps: int, seconds: float) -> None:
    found = gear_shift(m, substeps)
    assert found.final_time == pytest.approx(seconds, abs=1e-3)
    weights = np.vstack([1 - found.nodes.u[3:].sum(axis=0), found.nodes.u[3:]])
    gears = weights.argmax(axis=0) + 1
    assert weights.min() > -1e-6
    assert (np.diff(gears) >= 0).all() and gears[-1] >= 3
    if m < 40:
        assert weights.max(axis=0).min() > 0.99, "a gear is mixed"
    if m == 10:
        assert "".join(map(str, gears)) == "1222333333"


def test_replay_with_the_published_equations(gate_80: Plan) -> None:
    """Other equations (numpy, other sign of sideslip) and another integrator, over the whole drive."""
    nodes, mirror = gate_80.nodes, np.array([1, 1, 1, -1, 1, 1, 1])
    x = mirror * nodes.x[:, 0]
    for k, T in enumerate(nodes.T):
        x = solve_ivp(lambda _, z, k=k: gerdts(z, nodes.u[:, k]), (0, T), x, "DOP853", rtol=1e-9, atol=1e-9).y[:, -1]
        assert np.hypot(*(x - nodes.x[:, k + 1])[:2]) < 0.01
    assert gate_80.replay_error() < 0.01


def test_straight_road_is_the_closed_form() -> None:
    """Full drive all the way: t is the integral of ds/v, with v from the balance of forces."""
    points = np.column_stack([np.linspace(0, 170, 18), np.zeros(18)])
    found = plan(CAR, PathRoad(points, np.full((18, 2), 3.0)), 40, settings=replace(INTERPRETED, smoothing=0.0))
    data = single_track()

    def pull(v: float) -> float:
        f_r = 9e-3 + 7.2e-5 * v + 5.038848e-10 * v**4
        return (5000 - f_r * data.m * data.g - data.drag * v**2) / data.m

    end = solve_ivp(lambda s, v: pull(v[0]) / v, (0, 170), [10.0], rtol=1e-10).y[0, -1]
    assert found.nodes.x[2, -1] == pytest.approx(end, abs=1e-3)
    assert found.final_time == pytest.approx(quad(lambda v: 1 / pull(v), 10, end)[0], abs=1e-4)


def bend(angle: float = 0.0) -> PathRoad:
    """Straight, a left turn of 30 m radius, straight; turned by `angle` about the origin."""
    curvature = np.where((np.arange(33) >= 8) & (np.arange(33) < 18), 1 / 30, 0)
    line = np.cumsum(5 * np.exp(1j * (np.cumsum(curvature) * 5 + angle)))
    return PathRoad(np.column_stack([line.real, line.imag]), np.full((33, 2), 3.0))


def test_a_road_may_lie_anywhere() -> None:
    here, there = (plan(CAR, bend(angle), 30, settings=INTERPRETED) for angle in (0.0, 2.9))
    assert here.final_time == pytest.approx(there.final_time, abs=1e-6)
    turned = np.exp(2.9j) * (here.nodes.x[0] + 1j * here.nodes.x[1])
    np.testing.assert_allclose(turned, there.nodes.x[0] + 1j * there.nodes.x[1], atol=1e-3)
    assert here.violation < 0.05


def test_closed_road_ends_as_it_begins() -> None:
    angle = np.linspace(0, 2 * np.pi, 40, endpoint=False)
    oval = PathRoad(np.column_stack([60 * np.cos(angle), 40 * np.sin(angle)]), np.full((40, 2), 3.0), closed=True)
    free = np.array([0, *[FREE] * 6])
    found = plan(CAR, oval, 40, Ends(free, free), INTERPRETED)
    change = found.nodes.x[:, -1] - found.nodes.x[:, 0]
    np.testing.assert_allclose(change, [0, 0, 0, 0, 2 * np.pi, 0, 0], atol=1e-6)


def test_refinement_warm_starts() -> None:
    coarse, warm = refine(CAR, double_lane_change(), (20, 40), INTERPRETED)
    cold = plan(CAR, double_lane_change(), 40, settings=INTERPRETED)
    assert warm.final_time == pytest.approx(cold.final_time, abs=1e-5)
    assert warm.violation < coarse.violation
    assert warm.iterations <= cold.iterations + 5


def test_compiled_is_the_same_and_cached(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _compiler_needed()
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    first = plan(CAR, double_lane_change(), 20)
    (library,) = tmp_path.glob("plan-*/nlp.so")
    made = library.stat().st_mtime_ns
    again = plan(CAR, double_lane_change(), 20)
    assert library.stat().st_mtime_ns == made
    by_hand = plan(CAR, double_lane_change(), 20, settings=INTERPRETED)
    assert (first.how, again.how) == ("compiled", "compiled")
    assert first.final_time == pytest.approx(by_hand.final_time, abs=1e-7)


_DAMAGED = """
from pathlib import Path
from fmus.planner import hocp
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive
from fmus.cars.published import single_track

library = Path({library!r})
whole = library.read_bytes()
for share in (0.5, 0.97):
    damaged = library.with_name("damaged")
    damaged.write_bytes(whole[: int(share * len(whole))])
    damaged.replace(library)
    print(hocp.plan(two_wheel_drive(single_track()), double_lane_change(), 10).how, library.read_bytes() == whole)
"""


def test_a_cut_library_is_made_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In a process of its own: to load half a library ends the process."""
    _compiler_needed()
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join(sys.path))
    plan(CAR, double_lane_change(), 10)
    (library,) = tmp_path.glob("*/plan-*/nlp.so")
    line = [sys.executable, "-c", _DAMAGED.format(library=str(library))]
    done = subprocess.run(line, capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout) == (0, "compiled True\n" * 2), done.stderr


def test_a_library_that_cannot_be_loaded_is_said(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _compiler_needed()
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    monkeypatch.setattr("fmus.planner.compiled.functions.compiled", lambda *_: b"no library")
    found = plan(CAR, double_lane_change(), 10)
    assert re.fullmatch(r"interpreted, because .*nlp\.so cannot be loaded; may programs be run .*\?", found.how)


def test_libraries_not_used_for_a_month_are_removed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _compiler_needed()
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    old, other, long_ago = tmp_path / "plan-old", tmp_path / "Other-old", time() - 40 * 24 * 3600
    for folder in (old, other):
        folder.mkdir()
        os.utime(folder, (long_ago, long_ago))
    plan(CAR, double_lane_change(), 10)
    assert not old.exists() and other.exists()
    (used,) = (path.parent for path in tmp_path.glob("plan-*/nlp.so"))
    os.utime(used, (long_ago, long_ago))
    plan(CAR, double_lane_change(), 10)
    plan(CAR, double_lane_change(), 12)
    assert (used / "nlp.so").is_file()


def test_other_roads_share_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    _compiler_needed()
    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    for road in (double_lane_change(), double_lane_change(clearance=0.7), bend()):
        plan(CAR, road, 20)
    assert len(list(tmp_path.glob("plan-*/nlp.so"))) == 1


def test_without_a_compiler(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def none(_: str) -> tuple[str, ...]:
        raise BuildError("there is no compiler")

    monkeypatch.setattr("fmukit.store.cache_folder", lambda: tmp_path)
    monkeypatch.setattr(compiler, "command", none)
    compiler.identity.cache_clear()
    found = plan(CAR, double_lane_change(), 20)
    assert found.how == "interpreted, because there is no compiler"


def test_trajectory_file(gate_80: Plan, tmp_path: Path) -> None:
    file = tmp_path / "plan.csv"
    trajectory.write(gate_80, file)
    assert file.read_text().splitlines()[0] == ",".join(COLUMNS)
    t, x, y, course, v, a, curvature = np.loadtxt(file, delimiter=",", skiprows=1).T
    assert len(t) == 801 and (np.diff(t) > 0).all() and len(t) <= 4000
    np.testing.assert_allclose([x[0], x[-1], t[-1]], [-30, 140, gate_80.final_time], atol=1e-6)
    along = np.cumsum(0.5 * (v[1:] + v[:-1]) * np.diff(t))
    path = np.concatenate([[0], along])
    inside = np.abs(np.gradient(curvature, t)) < 3  # away from the jumps of the inputs
    np.testing.assert_allclose(
        np.unwrap(np.arctan2(np.gradient(y, t), np.gradient(x, t)))[1:-1], course[1:-1], atol=5e-3
    )
    np.testing.assert_allclose(np.gradient(course, path)[inside], curvature[inside], atol=5e-3)
    assert v[-1] ** 2 - v[0] ** 2 == pytest.approx(2 * np.sum(0.5 * (a[1:] + a[:-1]) * np.diff(path)), rel=0.01)


def test_what_cannot_be_planned() -> None:
    road = double_lane_change()
    with pytest.raises(PlanningError, match=r"the speed at the start is 70; it must be in \[3, 60\]"):
        plan(CAR, road, 20, standing_ends(70.0))
    with pytest.raises(PlanningError, match="the lateral position at the start is 9"):
        plan(CAR, road, 20, Ends(np.array([0, 9, 10, 0, 0, 0, 0]), standing_ends().last))
    with pytest.raises(PlanningError, match="narrower than the car"):
        plan(CAR, double_lane_change(clearance=1.3, width=1.5), 20)
    with pytest.raises(PlanningError, match="at least 2 intervals"):
        plan(CAR, road, 1)
    with pytest.raises(PlanningError, match="use the gate grid"):
        plan(CAR, bend(), 20, settings=PlanSettings(grid="time"))
    with pytest.raises(PlanningError, match="Maximum_Iterations_Exceeded after 3 iterations"):
        plan(CAR, road, 20, settings=replace(INTERPRETED, max_iterations=3))
    with pytest.raises(PlanningError, match="cannot be written"):
        trajectory.write(plan(CAR, road, 20, settings=INTERPRETED), Path("/no/such/folder/plan.csv"))


def _compiler_needed() -> None:
    try:
        compiler.command(compiler.host_platform())
    except BuildError as error:
        pytest.skip(str(error))


def test_reference_trajectory_plays_the_plan(gate_80: Plan) -> None:
    """Between its rows too, where an integrator from the nodes says what is right."""
    player = Direct(COMPONENT, table=trajectory.table(gate_80))
    times, x, _ = fine(CAR, gate_80.nodes, 2, 37)
    for _ in range(350):
        player.sample(0.02)
        t = (player.samples - 1) * 0.02
        expected = [np.interp(t, times, row) for row in (x[0], x[1], x[3] + x[4], x[2])]
        seen = [player[f"reference.{name}"] for name in ("x", "y", "course", "speed")]
        assert seen == pytest.approx(expected, abs=2e-3)
