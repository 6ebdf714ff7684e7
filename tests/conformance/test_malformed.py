"""Archives and documents from strangers: `fmus check` and the master's loader say one thing and touch nothing else."""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from pathlib import Path

import pytest
from malformed import ESCAPE, MALFORMED
from program import fmus

from cosim.engine.loader import Loader
from cosim.errors import CosimError
from cosim.model.system import System
from fmukit.conformance.check import check

every_file = pytest.mark.parametrize("what", MALFORMED)


@pytest.fixture
def bad(what: str, good: Path, tmp_path: Path) -> Path:
    """The malformed file, alone in a folder two levels deep, where escapes would be seen."""
    folder = tmp_path / "around" / "inside"
    folder.mkdir(parents=True)
    MALFORMED[what](good, folder / "bad.fmu")
    return folder / "bad.fmu"


def _around(bad: Path) -> set[Path]:
    return {path for path in bad.parents[2].rglob("*") if path.is_file()}


@every_file
def test_check_reports_a_failing_rule(what: str, bad: Path) -> None:
    done = fmus("check", bad, "--json")
    assert done.status == 1
    records = json.loads(done.out)
    failed = [record for record in records if record["status"] == "fail"]
    assert 1 <= len(failed) <= 3
    for record in failed:
        (first, *_) = record["seen"]
        assert "\n" not in first
        assert "Error:" not in first  # no rule broke down
        assert record["remedy"]
    assert {record["status"] for record in records if record["rule"][0] in "LBI"} == {"skip"}
    assert _around(bad) == {bad}


@every_file
def test_the_loader_refuses_in_one_sentence(what: str, bad: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    unpacked = bad.parent / "unpacked"
    unpacked.mkdir()
    monkeypatch.setattr("tempfile.tempdir", str(unpacked))
    system = System()
    system.add("stranger", str(bad))
    with pytest.raises(CosimError) as refusal, Loader(Path) as loader:
        loader.faces(system)
    sentence = str(refusal.value)
    assert str(bad) in sentence
    assert "\n" not in sentence
    assert len(sentence) < 500
    assert _around(bad) == {bad}


@pytest.mark.parametrize("what", ["billion laughs"])
def test_laughter_takes_no_memory(bad: Path) -> None:
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    check(bad, "AX")
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before < 50_000  # kB


def test_the_table_does_not_steer_the_terminal(good: Path, tmp_path: Path) -> None:
    ESCAPE(good, tmp_path / "bad.fmu")
    done = fmus("check", tmp_path / "bad.fmu", "--groups", "AX")
    assert r"\x9b31m" in done.out
    assert "\x9b" not in done.out


@pytest.mark.parametrize("what", ["not a zip"])
def test_the_command_shows_no_traceback(bad: Path) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "fmus", "check", str(bad)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join(sys.path), "COLUMNS": "200"},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (1, "")
    assert "is not a readable zip archive: File is not a zip file" in done.stdout
    assert "Traceback" not in done.stdout
