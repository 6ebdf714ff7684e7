"""Last points to brake and to steer: closed forms, bounds of a point mass, other equations, another integrator."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from fmus.cars.published import single_track
from fmus.planner.errors import PlanningError
from fmus.planner.evasion import table
from fmus.planner.evasion.braking import impact_speed, stopping_distance, stopping_distance_of_car
from fmus.planner.evasion.last_point import LastPoint, Search, Task, search
from fmus.planner.evasion.situation import Surroundings

CAR = single_track()
EDGE = Surroundings().edge
# To 2.5 m steering only, and braking as well; to 3.5 m with yaw angle 0. Found by another program for the same problem.
REFERENCE = {
    15.0: (15.4, 13.7, 18.2),
    20.0: (20.4, 19.1, 24.8),
    25.0: (25.3, 24.3, 31.0),
    30.0: (30.4, 29.5, 37.2),
    35.0: (35.4, 34.5, 43.4),
}


@pytest.fixture(scope="module")
def free() -> Search:
    return search(edge=False, compile_=False)


@pytest.fixture(scope="module")
def road() -> Search:
    return search(edge=True)


@pytest.mark.parametrize("v", REFERENCE)
def test_reference_table(free: Search, v: float) -> None:
    tasks = Task(v, 1.0, 2.5, "steer"), Task(v, 1.0, 2.5, "drive"), Task(v, 1.0, 3.5, "drive", straight=True)
    assert [free.solve(task).distance for task in tasks] == pytest.approx(REFERENCE[v], rel=0.005)


def test_steering_wins_above_sixteen_metres_per_second(free: Search) -> None:
    def gain(v: float) -> float:
        return stopping_distance(v, 1.0, 8.0) - free.solve(Task(v, 1.0, 2.5, "steer")).distance

    assert gain(16.0) < 0 < gain(17.0)


def independent(t: float, x: np.ndarray, u: np.ndarray, mu: float) -> list[float]:
    """The car in body velocities and plain numpy: x, y, v_x, v_y, yaw, yaw rate, steering angle."""
    c = CAR
    _, _, v_x, v_y, yaw, r, delta = x
    load = np.array([c.l_R, c.l_F]) * c.m * c.g / (c.l_F + c.l_R)
    slip = np.array([delta - math.atan((v_y + c.l_F * r) / v_x), -math.atan((v_y - c.l_R * r) / v_x)])
    force = []
    for tyre, alpha, F_z, U in zip((c.front, c.rear), slip, load, u[1:], strict=True):
        Ba = tyre.B / mu * alpha
        peak = mu * tyre.D * math.sqrt(max(1 - (U / (mu * F_z)) ** 2, 0) + 1e-4)
        force.append(peak * math.sin(tyre.C * math.atan(Ba - tyre.E * (Ba - math.atan(Ba)))))
    v = math.hypot(v_x, v_y)
    along = u[1:] - (9e-3 + 7.2e-5 * v + 5.038848e-10 * v**4) * load
    F_x = along[0] * math.cos(delta) - force[0] * math.sin(delta) + along[1] - c.drag * v**2
    F_yf = force[0] * math.cos(delta) + along[0] * math.sin(delta)
    return [
        v_x * math.cos(yaw) - v_y * math.sin(yaw),
        v_x * math.sin(yaw) + v_y * math.cos(yaw),
        F_x / c.m + v_y * r,
        (F_yf + force[1]) / c.m - v_x * r,
        r,
        (c.l_F * F_yf - c.l_R * force[1]) / c.I_zz,
        u[0],
    ]


def replayed(found: LastPoint, speed: float, mu: float) -> np.ndarray:
    """The states of `independent` at the nodes of the motion."""
    x = [np.array([0, 0, speed, 0, 0, 0, 0.0])]
    for u, T in zip(found.nodes.u.T, found.nodes.T, strict=True):
        x.append(solve_ivp(independent, (0, T), x[-1], "DOP853", rtol=1e-9, atol=1e-9, args=(u, mu)).y[:, -1])
    return np.array(x).T


@pytest.mark.parametrize(("mu", "means"), [(1.0, "steer"), (1.0, "brake"), (0.3, "steer"), (0.3, "brake")])
def test_replay_with_other_equations(free: Search, mu: float, means: str) -> None:
    found = free.solve(Task(25.0, mu, 2.5, means))  # type: ignore[arg-type]
    x = replayed(found, 25.0, mu)
    assert np.hypot(*(x[:2] - found.nodes.x[:2])).max() < 0.01
    assert x[:2, -1] == pytest.approx([found.distance, 2.5], abs=0.01)


def test_with_an_edge_the_car_is_straight_again_within_the_road(road: Search, free: Search) -> None:
    task = Task(30.0, 1.0, 2.5, "steer", EDGE)
    found = road.solve(task)
    x = replayed(found, 30.0, 1.0)
    passed = int(np.argmax(found.nodes.x[0] >= found.distance - 1e-6))
    assert found.nodes.x[1, passed:].min() > 2.5 - 1e-3 and x[1].max() < EDGE + 0.05
    assert np.abs(x[4:, -1]).max() < 0.05 and abs(x[3, -1]) < 0.5
    assert found.distance > free.solve(replace(task, edge=None)).distance


@pytest.mark.parametrize("mu", [0.3, 1.0])
@pytest.mark.parametrize("offset", [1.5, 3.5])
def test_a_point_mass_is_faster(free: Search, mu: float, offset: float) -> None:
    """Sideways acceleration at most that of both axles at their peaks: t >= sqrt(2 d / a)."""
    most = mu * (CAR.front.D + CAR.rear.D) / CAR.m + 0.15  # and the resistances, turned by the yaw angle
    found = free.solve(Task(25.0, mu, offset, "steer"))
    least = math.sqrt(2 * offset / most)
    assert least < found.nodes.times[-1] < 1.6 * least
    brake = mu * 1e4 / CAR.m
    both = free.solve(Task(25.0, mu, offset, "brake"))
    # with both at once, each axle at the corner of its rectangle of forces
    fastest = math.sqrt(2 * offset / math.hypot(most, brake))
    assert both.distance > 25 * fastest - 0.5 * (brake + 0.5) * fastest**2


def test_it_only_gets_harder() -> None:
    """Over speed, offset and slipperiness; and brakes help."""
    rows = table.read().rows
    shape = len(table.FRICTIONS), len(table.OFFSETS), len(table.SPEEDS)
    for column in ("brake", "brake_of_car", "steer", "brake_and_steer"):
        grid = rows[:, table.COLUMNS.index(column)].reshape(shape)
        assert (np.diff(grid, axis=2) > 0).all() and (np.diff(grid, axis=0) < 0).all()
        if "steer" in column:
            assert (np.diff(grid, axis=1) > 0).all()
    assert (rows[:, -1] <= rows[:, -2]).all() and (rows[:, 4] < rows[:, 3]).all()


def test_stopping_distance() -> None:
    assert stopping_distance(20.0, 1.0, 8.0) == 25.0
    assert stopping_distance(20.0, 0.5, 8.0) == 50.0

    def resisted(v: float) -> float:
        f_r = 9e-3 + 7.2e-5 * v + 5.038848e-10 * v**4
        return v * CAR.m / (0.6 * 1e4 + f_r * CAR.m * CAR.g + CAR.drag * v**2)

    assert stopping_distance_of_car(30.0, 0.6) == pytest.approx(quad(resisted, 0, 30.0)[0], rel=1e-3)


def test_impact_speed() -> None:
    assert impact_speed(20.0, 1.0, 8.0, 16.0) == pytest.approx(12.0)
    assert impact_speed(20.0, 1.0, 8.0, 25.0) == 0.0 == impact_speed(20.0, 1.0, 8.0, 99.0)
    assert impact_speed(20.0, 1.0, 8.0, 0.0) == 20.0


@pytest.mark.parametrize("place", [(1.0, 2.5, 25.0), (0.3, 3.5, 35.0), (0.6, 1.5, 15.0)])
def test_the_table_is_that_of_this_car(road: Search, place: tuple[float, float, float]) -> None:
    mu, offset, v = place
    fresh = table.compute(frictions=(mu,), offsets=(offset,), speeds=(v,), using=road).rows[0]
    kept = [table.read().at(column, *place) for column in table.COLUMNS[3:]]
    assert fresh[3:] == pytest.approx(kept, rel=5e-3)


@pytest.mark.nightly
def test_the_whole_table_is_that_of_this_car() -> None:
    np.testing.assert_allclose(table.compute().rows, table.read().rows, rtol=1e-2)


def test_between_the_points_of_the_table(road: Search) -> None:
    """Within what the reserve of the decision covers, and rather too long than too short."""
    for mu, offset, v in ((0.75, 2.0, 27.0), (0.42, 3.0, 18.0)):
        for column, means in (("steer", "steer"), ("brake_and_steer", "brake")):
            true = road.solve(Task(v, mu, offset, means, EDGE)).distance  # type: ignore[arg-type]
            assert -0.01 < table.read().at(column, mu, offset, v) / true - 1 < 0.03


def test_a_table_is_kept_as_csv(tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    table.write(table.read(), file)
    again = table.read(file)
    np.testing.assert_allclose(again.rows, table.read().rows, rtol=1e-5)
    assert again.at("steer", 0.3, 1.5, 15.0) == pytest.approx(again.rows[0, 5])
    assert again.at("steer", 1.0, 3.5, 35.0) == pytest.approx(again.rows[-1, 5])


@pytest.mark.parametrize(
    ("place", "sentence"),
    [
        ((1.0, 2.5, 36.0), "the speed is 36 m/s; the table of last points holds 15 to 35 m/s"),
        ((0.2, 2.5, 20.0), "the friction is 0.2; the table of last points holds 0.3 to 1"),
        ((1.0, 5.0, 20.0), "the lateral offset is 5 m"),
        ((1.0, 2.5, math.nan), "the speed is nan"),
    ],
)
def test_beyond_the_table(place: tuple[float, float, float], sentence: str) -> None:
    with pytest.raises(PlanningError, match=sentence):
        table.read().at("steer", *place)


@pytest.mark.parametrize(
    "text", ["", "a,b\n1,2\n", "1,2\n" + ",".join(["1"] * 7) + "\n", ",".join(table.COLUMNS) + "\n1,2,x,4,5,6,7\n"]
)
def test_what_is_no_table(tmp_path: Path, text: str) -> None:
    file = tmp_path / "table.csv"
    file.write_text(text)
    with pytest.raises(PlanningError, match=r"table\.csv (is no table|must begin)"):
        table.read(file)
    with pytest.raises(PlanningError, match="cannot be written"):
        table.write(table.read(), tmp_path / "none" / "table.csv")


def test_what_cannot_be_done(road: Search) -> None:
    with pytest.raises(PlanningError, match=r"an offset of 3\.9 m is beyond the edge of the road, 3\.8 m"):
        road.solve(Task(15.0, 1.0, 3.9, "steer", 3.8))
    with pytest.raises(PlanningError, match=r"no motion leads 3 m to the side from 3 m/s on friction 1 \(IPOPT: "):
        road.solve(Task(3.0, 1.0, 3.0, "full brakes", EDGE))
    with pytest.raises(PlanningError, match="needs a search with one"):
        road.solve(Task(15.0, 1.0, 2.5, "steer"))
