"""`fmus plan` with --car, --forces and --lost-motor, as a user meets them."""

from __future__ import annotations

import csv
import json
import sys
from pathlib import Path

import numpy as np
import pytest

from fmus.cars.nominal import DESIGN
from fmus.command.main import main

SHORT = ("double-lane-change", "-m", "20", "--json")


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["fmus", "plan", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


def columns(file: Path) -> dict[str, np.ndarray]:
    with file.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    return {name: np.array([float(row[name]) for row in rows]) for name in rows[0]}


def test_forces_beside_the_trajectory(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, *SHORT, "--forces", "forces.csv", "--lost-motor", "rr", "--lost-motor", "fr") == 0
    figures, found = json.loads(capsys.readouterr().out), columns(tmp_path / "forces.csv")
    path = np.loadtxt(tmp_path / "double-lane-change-plan.csv", delimiter=",", skiprows=1)
    np.testing.assert_allclose(found["time"], path[:, 0])
    assert not found["wheel_force.rr"].any() and not found["wheel_force.fr"].any()
    assert found["wheel_force.fl"].max() > 1000
    for name in ("force_x", "force_y", "moment_z"):
        residual = found[f"residual.{name}"]
        assert figures[f"residual_{name}_rms"] == pytest.approx(np.sqrt(np.mean(residual**2)), rel=1e-6)
        assert figures[f"residual_{name}_max"] == pytest.approx(np.abs(residual).max(), rel=1e-6)
    assert figures["residual_moment_z_rms"] > 100
    assert figures["forces_file"] == "forces.csv"


def test_car_of_the_multibody_plant(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Its wanted force at full drive is what accelerates 1500 kg, and its four wheels give it."""
    monkeypatch.chdir(tmp_path)
    assert run(monkeypatch, *SHORT, "--car", "vehicle16dof", "--forces", "forces.csv") == 0
    found = columns(tmp_path / "forces.csv")
    path = np.loadtxt(tmp_path / "double-lane-change-plan.csv", delimiter=",", skiprows=1)
    assert found["wanted.force_x"][0] == pytest.approx(DESIGN.mass * path[0, 5], rel=1e-6)
    total = sum(found[f"wheel_force.{wheel}"] for wheel in ("fl", "fr", "rl", "rr"))
    assert total[0] == pytest.approx(5000, rel=1e-3)
    assert json.loads(capsys.readouterr().out)["final_time"] == pytest.approx(7.71, abs=0.05)


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--lost-motor", "rr"], "name their file with --forces"),
        (["--forces", "f.csv", "--lost-motor", "middle"], "'middle' is not one of"),
        (["--car", "moon"], "'moon' is not one of"),
        (["--forces", "none/f.csv"], "none/f.csv cannot be written (No such file or directory)"),
        (["--forces", "."], "cannot be written (Is a directory)"),
        (["--forces", "a.csv", "-o", "a.csv"], "trajectory and forces cannot both be written to a.csv; name two files"),
        (["--forces", "double-lane-change-plan.csv"], "name two files"),
        (["--forces", "b.csv", "-o", "there/../b.csv"], "name two files"),
    ],
)
def test_wrong_options(
    arguments: list[str],
    sentence: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there").mkdir()
    assert run(monkeypatch, *SHORT, *arguments) == 2
    error = capsys.readouterr().err
    assert sentence in error and len(error.splitlines()) == 1
    assert [file.name for file in tmp_path.iterdir()] == ["there"], "found before the search, nothing left behind"


def test_a_file_that_is_there_is_kept_when_there_is_no_plan(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.csv").write_text("kept")
    assert run(monkeypatch, *SHORT, "-o", "a.csv", "--speed", "99") == 2
    assert (tmp_path / "a.csv").read_text() == "kept"


@pytest.mark.parametrize("option", ["-o", "--forces"])
@pytest.mark.parametrize("other", ["road.csv", "linked.csv"])
def test_the_road_is_not_replaced(
    option: str, other: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    rows = "x,y,width_left,width_right\n" + "".join(f"{10 * k},0,3,3\n" for k in range(18))
    (tmp_path / "road.csv").write_text(rows)
    (tmp_path / "linked.csv").hardlink_to(tmp_path / "road.csv")
    assert run(monkeypatch, "road.csv", "-m", "20", option, other) == 2
    assert f"{other} is the road itself, which the plan would replace; name another file" in capsys.readouterr().err
    assert (tmp_path / "road.csv").read_text() == rows
