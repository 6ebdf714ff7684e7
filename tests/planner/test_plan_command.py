"""`cosim plan` as a user meets it."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from cosim.cli import main


def run(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    monkeypatch.setattr(sys, "argv", ["cosim", "plan", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


def test_figures_and_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "plan.csv"
    assert run(monkeypatch, "double-lane-change", "-m", "20", "--json", "-o", str(file)) == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["final_time"] == pytest.approx(7.17, abs=0.05)
    assert figures["replay_error"] < 0.01
    assert np.loadtxt(file, delimiter=",", skiprows=1).shape == (201, 7)


def test_road_of_a_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    rows = "".join(f"{10 * k},0,3,3\n" for k in range(18))
    (tmp_path / "road.csv").write_text("x,y,width_left,width_right\n" + rows)
    assert run(monkeypatch, "road.csv", "-m", "20", "--speed", "20") == 0
    assert (tmp_path / "road-plan.csv").is_file()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["double-lane-chnge"], "did you mean double-lane-change?"),
        (["moon"], "known are double-lane-change, test-drive"),
        (["none.csv"], "cannot be read"),
        (["double-lane-change", "--speed", "99"], "the speed at the start is 99"),
        (["double-lane-change", "--speed", "nan"], "give a speed"),
        (["double-lane-change", "-m", "0"], "at least 2 intervals"),
    ],
)
def test_mistakes(
    arguments: list[str], sentence: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(monkeypatch, *arguments) == 2
    error = capsys.readouterr().err
    assert sentence in error and len(error.splitlines()) == 1
