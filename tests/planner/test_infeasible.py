"""Roads and ends that no plan can meet: refused before the search, or explained after it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from fmus.cars.published import single_track
from fmus.planner import bends
from fmus.planner.errors import PlanningError
from fmus.planner.hocp import PlanSettings, plan
from fmus.planner.path_road import PathRoad
from fmus.planner.program import Ends, standing_ends
from fmus.planner.road import double_lane_change
from fmus.planner.vehicle import two_wheel_drive

CAR = two_wheel_drive(single_track())
ROAD = double_lane_change()


def hairpin(radius: float, half_width: float, angle: float = 3.1, spacing: float = 0.5) -> PathRoad:
    """15 m straight, a left turn by `angle` [rad], 15 m straight."""
    lead, arc = round(15 / spacing), max(2, round(radius * angle / spacing))
    turn = np.concatenate([np.zeros(lead), np.full(arc, angle / arc), np.zeros(lead)])
    length = np.concatenate([np.full(lead, spacing), np.full(arc, radius * angle / arc), np.full(lead, spacing)])
    line = np.concatenate([[0], np.cumsum(length * np.exp(1j * np.cumsum(turn)))])
    return PathRoad(np.column_stack([line.real, line.imag]), np.full((len(line), 2), half_width))


def ends(first: dict[int, float] | None = None, last: dict[int, float] | None = None) -> Ends:
    """The usual ends with some states replaced."""
    result = standing_ends()
    for end, changes in ((result.first, first), (result.last, last)):
        for index, value in (changes or {}).items():
            end[index] = value
    return result


def test_a_start_too_fast_is_told_the_speed_that_does() -> None:
    with pytest.raises(PlanningError, match=r"IPOPT: .* there is one that starts with a speed of (\d+)") as error:
        plan(CAR, ROAD, 20, standing_ends(58.0))
    speed = float(str(error.value).split("speed of ")[1].split()[0])
    assert 40 < speed < 58
    assert plan(CAR, ROAD, 20, standing_ends(speed - 0.1)).residual < 1e-6


def test_an_end_out_of_reach_is_told_the_end_in_reach() -> None:
    with pytest.raises(PlanningError, match=r"ends with a speed of 36\.\d+ instead of 59 m/s"):
        plan(CAR, ROAD, 20, ends(last={2: 59.0}))


def test_a_start_askew_is_told_the_heading_that_does() -> None:
    with pytest.raises(PlanningError, match=r"starts with .*heading of [-.\d]+ instead of 1 rad"):
        plan(CAR, ROAD, 20, ends(first={4: 1.0}))


def test_a_road_out_of_reach_is_told_the_place() -> None:
    """A hairpin a little wider than the smallest circle: only the search knows."""
    with pytest.raises(PlanningError, match=r"with free ends it breaks near x = (1\d|2\d)\.\d m"):
        plan(CAR, hairpin(3.2, 1.5), 60, settings=PlanSettings(max_iterations=100))


def test_a_bend_too_sharp_is_refused_before_the_search() -> None:
    with pytest.raises(PlanningError, match=r"the bend near x = 1\d\.\d m, y = .* smallest of this car is 4\.1 m"):
        plan(CAR, hairpin(2.0, 1.5), 60)
    with pytest.raises(PlanningError, match=r"the bend near x = 1\d\.\d m"):
        plan(CAR, hairpin(1.2, 1.0, np.pi / 2), 60)


def test_smallest_circle_is_that_of_the_geometry() -> None:
    """Slowly, wheels roll where they point: the centre of gravity runs on sqrt((L/tan delta)^2 + l_R^2)."""
    data, slow = single_track(), CAR.lower.copy()
    slow[2] = 0.3
    expected = np.hypot(data.wheelbase / np.tan(0.6), data.l_R)
    assert bends.smallest_circle(replace(CAR, lower=slow)) == pytest.approx(expected, rel=2e-3)


@pytest.mark.parametrize("angle", [np.pi / 3, np.pi / 2, 2.5])
@pytest.mark.parametrize("side", [1, -1])
def test_room_of_a_bend(angle: float, side: int) -> None:
    """The arc found touches the outer edges of both straights and the inner edge in the middle, by plane geometry."""
    r, w = 3.0, 0.5
    road = hairpin(r, w + 0.84, angle, 0.02)
    road = PathRoad(road.points * [1, side], road.widths)
    radius, k = bends.tightest_bend(road.gates(1500), 20.0)
    centre = np.array([15.0, side * r])
    inwards = np.array([-np.sin(angle / 2), side * np.cos(angle / 2)])
    middle = centre + (radius - (r - w)) * inwards
    outer = -side * (r + w) + centre[1]
    assert abs(middle[1] - outer) == pytest.approx(radius, rel=0.03)
    assert np.hypot(*(road.gates(1500).frames[k, :2] - centre)) == pytest.approx(r, abs=0.05)


def test_gates_far_apart() -> None:
    line = np.column_stack([np.linspace(0, 3000, 31), 20 * np.sin(np.linspace(0, 20, 31))])
    road = PathRoad(line, np.full((31, 2), 4.0))
    with pytest.raises(PlanningError, match=r"the gates are 15\d m apart, .* take at least 31 intervals"):
        plan(CAR, road, 20)
    slow = plan(CAR, road, 100, standing_ends(4.0))
    assert slow.nodes.T[0] > 2, "30 m from 4 m/s takes longer than intervals usually may"


def test_ordinary_roads_pass() -> None:
    bends.check_bends(CAR, ROAD.gates(80))
    bends.check_bends(CAR, hairpin(4.0, 2.0).gates(100))
    assert plan(CAR, hairpin(4.0, 2.0), 60).status == "Solve_Succeeded"
