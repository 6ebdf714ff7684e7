"""`fmus plan` as a user meets it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from cosim.command.main import main as cosim
from fmus.command.main import main
from fmus.planner import plans
from fmus.planner.path_road import PathRoad
from tests.references.circuits import circuit


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["fmus", "plan", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


def test_figures_and_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plan.csv"
    assert run(monkeypatch, "double-lane-change", "-m", "20", "--json", "-o", str(file)) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["final_time"] == pytest.approx(7.17, abs=0.05)
    assert figures["replay_error"] < 0.01 and figures["residual"] < 1e-6
    assert figures["status"] == "Solve_Succeeded" and figures["iterations"] > 0 and figures["solve_time"] > 0
    assert np.loadtxt(file, delimiter=",", skiprows=1).shape == (201, 7)


def test_the_former_name_still_plans(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """`cosim plan` is found by its entry point, says its new name, and knows the same options and mistakes."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "argv", ["cosim", "plan", "double-lane-change", "-m", "20", "--json"])
    with pytest.raises(SystemExit) as end:
        cosim()
    seen = capsys.readouterr()
    assert not end.value.code and json.loads(seen.out)["file"] == "double-lane-change-plan.csv"
    assert seen.err.splitlines()[0] == "fmus: `cosim plan` is `fmus plan` now"
    monkeypatch.setattr(sys, "argv", ["cosim", "plan", "moon"])
    with pytest.raises(SystemExit) as end:
        cosim()
    assert end.value.code == 2 and "known are double-lane-change" in capsys.readouterr().err


def test_a_coarse_mesh_is_remarked_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(tmp_path / "plan.csv")
    assert run(monkeypatch, "double-lane-change", "-m", "10", "--speed", "50", "--json", "-o", file) == 0
    seen = capsys.readouterr()
    assert json.loads(seen.out)["violation"] > 0.2
    assert "between its nodes the plan leaves the road by" in seen.err and "take more intervals" in seen.err
    assert run(monkeypatch, "double-lane-change", "-m", "40", "-o", file) == 0
    assert not capsys.readouterr().err


def test_searches_that_stopped_early_are_remarked_on() -> None:
    assert plans.remarks(0.0, 0.0, 1e-9, "Solve_Succeeded") == []
    (stopped,) = plans.remarks(0.0, 0.0, 1e-9, "Solved_To_Acceptable_Level")
    assert "Solved_To_Acceptable_Level" in stopped
    (broken,) = plans.remarks(0.0, 0.0, 3e-4, "Solve_Succeeded")
    assert "breaks its constraints by 0.0003" in broken


def test_a_road_that_is_no_text(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "road.csv").write_bytes(bytes(range(256)))
    assert run(monkeypatch, str(tmp_path / "road.csv")) == 2
    assert "it is not a text in UTF-8" in capsys.readouterr().err


def test_road_of_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{10 * k},0,3,3\n" for k in range(18))
    (tmp_path / "road.csv").write_text("x,y,width_left,width_right\n" + rows)
    assert run(monkeypatch, "road.csv", "-m", "20", "--speed", "20") == 0
    assert (tmp_path / "road-plan.csv").is_file()


def test_flying_lap_of_a_race_track(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The file as published; open, the same file is planned from its first point on, with a remark."""
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{x:.6f},{y:.6f},{w[1]:.3f},{w[0]:.3f}\n" for (x, y), w in _rows(circuit("eight")))
    (tmp_path / "track.csv").write_text("# x_m,y_m,w_tr_right_m,w_tr_left_m\n" + rows)
    assert run(monkeypatch, "track.csv", "--closed", "--json") == 0
    seen = capsys.readouterr()
    figures = json.loads(seen.out)
    assert not seen.err and figures["violation"] <= 0.02
    path = np.loadtxt(tmp_path / "track-plan.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(path[-1, 1:3], path[0, 1:3], atol=1e-5)
    assert path[-1, 4] == pytest.approx(path[0, 4], abs=1e-5) and figures["final_time"] == pytest.approx(path[-1, 0])
    assert run(monkeypatch, "track.csv", "--json") == 0
    seen = capsys.readouterr()
    assert json.loads(seen.out)["final_time"] > figures["final_time"], "from 10 m/s on"
    assert seen.err == "fmus: track.csv ends where it begins; with --closed the flying lap is planned\n"
    assert run(monkeypatch, "track.csv", "--closed", "--speed", "20") == 2
    assert "a flying lap has no start" in capsys.readouterr().err


def _rows(road: PathRoad) -> zip:
    return zip(road.points.tolist(), road.widths.tolist(), strict=True)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["double-lane-change", "--closed"], "only the CSV file of a road can be closed"),
        (["double-lane-chnge"], "did you mean double-lane-change?"),
        (["moon"], "known are double-lane-change, test-drive"),
        (["none.csv"], "table none.csv cannot be read (No such file or directory)"),
        (["double-lane-change", "-m", "2"], "; there is one on 40 intervals, take more of them"),
        (["double-lane-change", "--speed", "99"], "the speed at the start is 99"),
        (["double-lane-change", "--speed", "nan"], "give a speed"),
        (["double-lane-change", "--speed", "2"], "the speed at the start is 2; it must be in [3, 60]"),
        (["double-lane-change", "-m", "20", "--speed", "58"], "there is one that starts with a speed of"),
        (["double-lane-change", "-m", "0"], "at least 2 intervals"),
        (["double-lane-change", "-m", "-5"], "at least 2 intervals"),
        (["double-lane-change", "-m", "4000"], "the most is 3999"),
        (["double-lane-change", "-m", "20", "-o", "/no/such/folder/plan.csv"], "cannot be written"),
    ],
)
def test_mistakes(
    arguments: list[str], sentence: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, *arguments) == 2
    error = capsys.readouterr().err
    assert sentence in error and len(error.splitlines()) == 1


ROADS = {
    "narrow": (
        "0,0,3,3\n20,0,0.8,0.8\n40,0,3,3\n60,0,3,3\n",
        "the corridor is narrower than the car by 0.08 m near x = 20",
    ),
    "sharp": ("0,0,1,1\n10,0,1,1\n11,0.5,1,1\n11,1.5,1,1\n10,2,1,1\n0,2,1,1\n", "the smallest of this car is 4.1 m"),
    "folded": ("0,0,9,9\n10,0,9,9\n14,4,9,9\n10,8,9,9\n0,8,9,9\n", "the road turns too sharply for its width"),
    "no number": ("0,0,3,3\n10,?,3,3\n20,0,3,3\n30,0,3,3\n", "row 3: expected 4 finite numbers"),
    "short": ("0,0,3,3\n10,0,3,3\n", "has 2 points"),
    "negative": ("0,0,3,3\n10,0,-3,3\n20,0,3,3\n30,0,3,3\n", "negative width in row 2"),
}


@pytest.mark.parametrize("name", ROADS)
def test_bad_roads(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rows, sentence = ROADS[name]
    (tmp_path / "road.csv").write_text("x,y,width_left,width_right\n" + rows)
    assert run(monkeypatch, str(tmp_path / "road.csv"), "-m", "40", "-o", str(tmp_path / "plan.csv")) == 2
    error = capsys.readouterr().err
    assert sentence in error.replace("\n", " ") and len(error.splitlines()) == 1
    assert not (tmp_path / "plan.csv").exists(), "no plan, no file"


def test_a_centre_line_has_no_time_grid(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    rows = "".join(f"{10 * k},0,3,3\n" for k in range(18))
    (tmp_path / "road.csv").write_text("x,y,width_left,width_right\n" + rows)
    assert run(monkeypatch, str(tmp_path / "road.csv"), "-m", "20", "--grid", "time") == 2
    error = capsys.readouterr().err
    assert "use the gate grid for a centre line" in error and len(error.splitlines()) == 1
