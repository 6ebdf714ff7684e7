"""Roads: the double lane change against its published form, centre lines against circles, and bad files."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from fmus.planner.errors import PlanningError
from fmus.planner.path_road import PathRoad
from fmus.planner.road import double_lane_change
from fmus.planner.road_file import read_road
from fmus.planner.road_rows import is_ring


def published(x: float) -> tuple[float, float]:
    """Edges of the test drive as printed, B = 1.5."""
    B = 1.5
    h1, h2, h3, h4 = 1.1 * B + 0.25, 3.5, 1.2 * B + 3.75, 1.3 * B + 0.25
    lower = [(44, 0), (44.5, 4 * h2 * (x - 44) ** 3), (45, 4 * h2 * (x - 45) ** 3 + h2), (70, h2)]
    lower += [(70.5, 4 * h2 * (70 - x) ** 3 + h2), (71, 4 * h2 * (71 - x) ** 3), (np.inf, 0)]
    upper = [(15, h1), (15.5, 4 * (h3 - h1) * (x - 15) ** 3 + h1), (16, 4 * (h3 - h1) * (x - 16) ** 3 + h3), (94, h3)]
    upper += [(94.5, 4 * (h3 - h4) * (94 - x) ** 3 + h3), (95, 4 * (h3 - h4) * (95 - x) ** 3 + h4), (np.inf, h4)]
    return next(y for end, y in lower if x <= end), next(y for end, y in upper if x <= end)


def test_published_edges() -> None:
    limits = double_lane_change(1.0, 0.75, 1.5, "cubic").limits()
    for x in np.linspace(-30, 140, 1701):
        low, high = (float(value) for value in limits(x))
        assert (low - 0.75, high + 0.75) == pytest.approx(published(x), abs=1e-12)


def test_widths_and_transition() -> None:
    road = double_lane_change()
    B, limits = 1.68, road.limits()
    for x, low, high in ((-30, 0, 1.1 * B + 0.25), (55, 3.5, 1.2 * B + 3.75), (140, 0, 1.3 * B + 0.25)):
        assert [float(y) for y in limits(x)] == pytest.approx([low + 0.84, high - 0.84])
    assert float(limits(44.5)[0]) == pytest.approx(1.75 + 0.84), "the step is not centred"
    assert float(limits(42.0)[0]) == pytest.approx(0.84) and float(limits(42.1)[0]) > 0.84
    h = 1e-3  # second differences are continuous across the beginning of a transition
    second = [(limits(x + h)[0] - 2 * limits(x)[0] + limits(x - h)[0]) / h**2 for x in (41.99, 42.01)]
    assert abs(float(second[1] - second[0])) < 0.2


def test_violation_of_the_corridor() -> None:
    road = double_lane_change()
    assert road.violation(np.array([[-10, 1.0], [55, 4.5]])) == 0
    assert road.violation(np.array([[-10, 0.5], [55, 4.5]])) == pytest.approx(0.34)


def circle(radius: float, count: int = 60) -> np.ndarray:
    angle = np.linspace(0, 2 * np.pi, count, endpoint=False)
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def test_closed_circle() -> None:
    road = PathRoad(circle(50.0), np.tile([3.0, 2.0], (60, 1)), clearance=1.0, closed=True)
    gates = road.gates(24)
    np.testing.assert_allclose(np.hypot(*gates.frames[:, :2].T), 50, atol=1e-4)
    np.testing.assert_allclose(gates.steps[:, 2], 2 * np.pi / 24, atol=1e-4)
    np.testing.assert_allclose(np.hypot(*gates.point(gates.high).T), 48, atol=1e-4)
    assert gates.low == pytest.approx(np.full(25, -1.0))
    assert road.violation(circle(47.5)) == pytest.approx(0.5, abs=1e-3)
    assert road.violation(circle(51.6)) == pytest.approx(0.6, abs=1e-3)
    assert road.violation(circle(50.3)) == 0


def test_gate_steps_lead_from_gate_to_gate() -> None:
    line = np.column_stack([np.linspace(0, 100, 21), 8 * np.sin(np.linspace(0, 5, 21))])
    gates = PathRoad(line, np.full((21, 2), 3.0)).gates(30)
    place, heading = complex(*gates.frames[0, :2]), gates.frames[0, 2]
    for forward, left, turn in gates.steps:
        place += (forward + 1j * left) * np.exp(1j * heading)
        heading += turn
    assert place == pytest.approx(complex(*gates.frames[-1, :2]), abs=1e-9)


def test_narrow_and_sharp_roads() -> None:
    with pytest.raises(PlanningError, match=r"narrower than the car by 0\.39 m near x = -30"):
        double_lane_change(clearance=1.2, width=1.6).gates(20)
    with pytest.raises(PlanningError, match="turns too sharply for its width"):
        PathRoad(circle(4.0), np.full((60, 2), 6.0), closed=True).gates(30)
    with pytest.raises(PlanningError, match="transition length"):
        double_lane_change(transition=0.0)
    with pytest.raises(PlanningError, match="clearance"):
        double_lane_change(clearance=float("nan"))


HEADER = "x,y,width_left,width_right\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", "must start with the line"),
        ("a,b\n1,2\n", "must start with the line"),
        (HEADER + "0,0,3,3\n1,x,3,3\n", "row 3: .* finite numbers"),
        (HEADER + "0,0,3,3\n", "has 1 rows"),
        (HEADER + "0,0,3,nan\n1,0,3,3\n", "row 2: .* finite numbers"),
        (HEADER + "0,0,3\n1,0,3,3\n", "row 2: .* 4 finite numbers"),
        (HEADER + "0,0,3,3\n1,0,3,3\n", "has 2 points"),
        (HEADER + "0,0,3,3\n1,0,3,3\n2,0,-3,3\n3,0,3,3\n", "negative width in row 3"),
        (HEADER + "0,0,3,3\n1,0,3,3\n1,0,3,3\n3,0,3,3\n", "same point twice"),
    ],
)
def test_bad_files(tmp_path: Path, text: str, sentence: str) -> None:
    file = tmp_path / "road.csv"
    file.write_text(text)
    with pytest.raises(PlanningError, match=sentence):
        read_road(file)


def test_missing_file(tmp_path: Path) -> None:
    with pytest.raises(PlanningError, match="cannot be read"):
        read_road(tmp_path / "none.csv")


def test_a_good_file(tmp_path: Path) -> None:
    file = tmp_path / "road.csv"
    file.write_text(HEADER + "".join(f"{x},0,3,2\n" for x in range(0, 50, 10)))
    gates = read_road(file, clearance=1.0).gates(4)
    np.testing.assert_allclose(gates.frames[:, 0], [0, 10, 20, 30, 40], atol=1e-9)
    assert (gates.low[2], gates.high[2]) == (-1.0, 2.0)


TRACK = "# x_m,y_m,w_tr_right_m,w_tr_left_m\n"


def test_a_race_track_as_published(tmp_path: Path) -> None:
    """The width to the right comes first, the header behind a #, and the last point is joined to the first."""
    file = tmp_path / "track.csv"
    file.write_text(TRACK + "".join(f"{x:.6f},{y:.6f},2.000,3.000\n" for x, y in circle(50.0)))
    road = read_road(file, clearance=1.0, closed=True)
    assert road.gates(20).low == pytest.approx(np.full(21, -1.0)) and road.gates(20).high == pytest.approx(
        np.full(21, 2.0)
    )
    file.write_text("y,x,width_left,width_right\n" + "".join(f"0,{x},3,2\n" for x in (0, 10, 20, 30)))
    assert read_road(file).points[3].tolist() == [30.0, 0.0], "columns in any order"
    file.write_text(TRACK.replace("# ", "#").replace(",", ", ") + "0,0,2,3\n10,0,2,3\n20,0,2,3\n30,0,2,3\n")
    assert read_road(file).widths[0].tolist() == [3.0, 2.0]


def test_a_closed_road_may_repeat_its_first_point(tmp_path: Path) -> None:
    rows = [f"{x:.6f},{y:.6f},3,3\n" for x, y in circle(50.0)]
    file = tmp_path / "ring.csv"
    file.write_text(HEADER + "".join(rows + rows[:1]))
    assert len(read_road(file, closed=True).points) == 60
    assert is_ring(read_road(file).points), "open, it is a ring all the same"
    file.write_text(HEADER + "".join(rows + rows[1:3]))
    with pytest.raises(PlanningError, match="goes past its start: row 62"):
        read_road(file, closed=True)


def test_a_closed_road_that_is_no_ring(tmp_path: Path) -> None:
    file = tmp_path / "straight.csv"
    file.write_text(HEADER + "".join(f"{x},0,3,3\n" for x in range(0, 50, 10)))
    with pytest.raises(PlanningError, match=r"is no ring: row 5, its last, lies 40\.0 m from row 1"):
        read_road(file, closed=True)


def test_rings() -> None:
    assert is_ring(circle(50.0)) and not is_ring(circle(50.0)[:40])
    there_and_back = np.array([[x, 0.0] for x in range(0, 50, 5)] + [[x, 1.0] for x in range(50, -5, -5)])
    assert not is_ring(there_and_back), "it would have to turn round where it is joined"
