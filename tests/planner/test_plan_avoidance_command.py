"""`fmus plan collision-avoidance` as a user meets it, on a few points of the table."""

from __future__ import annotations

import json
import sys
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from fmus.command.main import main
from fmus.planner.evasion import table
from fmus.planner.evasion.last_point import search


@pytest.fixture
def plan(monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    few = partial(table.compute, frictions=(1.0,), offsets=(2.5,), speeds=(15.0, 25.0), using=search(edge=True))
    monkeypatch.setattr(table, "compute", few)
    return monkeypatch


def run(patch: pytest.MonkeyPatch, *arguments: str) -> int:
    patch.setattr(sys, "argv", ["fmus", "plan", "collision-avoidance", *arguments])
    with pytest.raises(SystemExit) as end:
        main()
    return int(end.value.code or 0)


def test_the_table_is_shown(plan: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(plan) == 0
    out, err = capsys.readouterr()
    slow, fast = (" ".join(line.replace("│", "").split()) for line in out.splitlines() if "2.32" in line)
    assert slow == "1 2.5 2.32 15 14.1 13.7 16.1 13.9 with brakes"
    assert fast == "1 2.5 2.32 25 39.1 37.9 26.8 25.3 wins"
    assert not err and "0.3 s after the obstacle appears" in out


def test_the_table_is_written(plan: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    file = tmp_path / "table.csv"
    assert run(plan, "--json", "-o", str(file)) == 0
    printed = json.loads(capsys.readouterr().out)
    rows = [list(row.values()) for row in printed["last_points"]]
    assert list(printed["last_points"][0]) == list(table.COLUMNS) and printed["file"] == str(file)
    assert printed["surroundings"]["reserve"] == 1.05
    np.testing.assert_allclose(table.read(file).rows, rows, rtol=1e-5)


def test_a_file_that_cannot_be_written_is_refused_before_the_search(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def compute(*_: object, **__: object) -> None:
        raise AssertionError("searched")

    monkeypatch.setattr(table, "compute", compute)
    assert run(monkeypatch, "-o", "/no/such/x.csv") == 2
    assert "/no/such/x.csv cannot be written" in capsys.readouterr().err


def test_the_file_of_the_table_is_written_as_it_is(tmp_path: Path) -> None:
    table.write(table.read(), tmp_path / "again.csv")
    assert (tmp_path / "again.csv").read_bytes() == table.FILE.read_bytes()


@pytest.mark.parametrize(
    ("arguments", "sentence"),
    [
        (["--speed", "20"], "collision-avoidance is a table of last points, not one plan; leave out --speed"),
        (["-m", "40", "--grid", "time"], "leave out --intervals, --grid"),
        (["-o", "/no/such/folder/table.csv"], "cannot be written (No such file or directory); name another file"),
    ],
)
def test_mistakes(
    arguments: list[str], sentence: str, plan: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert run(plan, *arguments) == 2
    error = capsys.readouterr().err
    assert sentence in error and len(error.splitlines()) == 1
