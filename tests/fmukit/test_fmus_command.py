"""The `fmus` command: what it prints, and one sentence for each mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from fmus import CATALOGUE

ROOT = Path(__file__).parents[2]


def _fmus(*arguments: str) -> subprocess.CompletedProcess[str]:
    program = "from fmus.cli import main; main()"
    return subprocess.run(
        [sys.executable, "-c", program, *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )


def test_list_json_holds_the_catalogue() -> None:
    listed = json.loads(_fmus("list", "--json").stdout)
    assert [entry["name"] for entry in listed] == [component.interface.name for component in CATALOGUE]
    assert all(port["unit"] and port["description"] for entry in listed for port in entry["ports"])


def test_build_makes_the_named_fmu(tmp_path: Path) -> None:
    done = _fmus("build", "Imu", "-d", str(tmp_path))
    assert done.returncode == 0
    assert [path.name for path in tmp_path.iterdir()] == ["Imu.fmu"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["build", "Nonsense"], "there is no FMU Nonsense; choose from"),
        (["build", "Imu", "--platform", "amiga"], "there is no platform amiga"),
        (["build", "Imu", "-d", "/proc/nowhere"], "/proc/nowhere"),
        (["lst"], "No such command 'lst'"),
        (["list", "--colour"], "No such option: --colour"),
    ],
)
def test_mistakes_give_one_sentence_and_status_2(arguments: list[str], words: str) -> None:
    done = _fmus(*arguments)
    assert done.returncode == 2
    last = done.stderr.strip().splitlines()[-1]
    assert last.startswith("fmus: ")
    assert words in last
    assert "Traceback" not in done.stderr
