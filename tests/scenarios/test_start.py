"""Where cars start: a trajectory that cannot be played is refused before anything runs, in the words of its player."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.errors import CosimError
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.discovery import load

HEADER = "time,x,y,course,speed,acceleration,curvature\n"


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (None, r"table .*t\.csv cannot be read .*No such file or directory.*; give the path of a CSV file"),
        (HEADER, "has 0 rows; it must have 2 to"),
        (
            "time,x,y,course\n0,0,0,0\n",
            "must start with the line time,x,y,course,speed,acc.*, not time,x,y,course$",
        ),
        (HEADER + "0,0,zero,0,20,0,0\n1,20,0,0,20,0,0\n", "row 2: expected 7 finite numbers, got 0,0,zero"),
        (HEADER + "0,0\n1,20,0,0,20,0,0\n", "row 2: expected 7 finite numbers, got 0,0"),
        (HEADER + "1,0,0,0,20,0,0\n1,20,0,0,20,0,0\n", "row 3: time must increase"),
    ],
)
def test_trajectory_files(tmp_path: Path, text: str | None, sentence: str) -> None:
    file = tmp_path / "t.csv"
    if text is not None:
        file.write_text(text)
    request = Request(load("lateral-tracking"), tmp_path / "out", [("reference.trajectory_file", str(file))])
    with pytest.raises(CosimError, match=sentence):
        run(request)
    assert not (tmp_path / "out").exists(), "nothing has run"
