"""The `fmus` command: what it prints, and one sentence for each mistake."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from fmukit.command_line import Subcommand, loaded, run
from fmukit.component import Component
from fmukit.python_kernel import packages
from fmus import CATALOGUE
from fmus.command.main import APPLICATION

ROOT = Path(__file__).parents[2]


def _fmus(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-m", "fmus", *arguments], cwd=ROOT, capture_output=True, text=True, check=False
    )


def test_list_json_holds_the_catalogue() -> None:
    listed = json.loads(_fmus("list", "--json").stdout)
    assert [entry["name"] for entry in listed] == [component.interface.name for component in CATALOGUE]
    assert all(port["unit"] and port["description"] for entry in listed for port in entry["ports"])


def test_list_says_what_the_host_of_an_fmu_needs() -> None:
    listed = {entry["name"]: entry["packages"] for entry in json.loads(_fmus("list", "--json").stdout)}
    assert {name: needed for name, needed in listed.items() if needed} == {
        component.interface.name: sorted(packages(component.kernel())) for component in CATALOGUE if component.packages
    }
    assert listed["RecedingHorizonPlanner"] == ["casadi", "numpy"]
    printed = " ".join(_fmus("list").stdout.split())
    assert printed.count("needs Python with casadi and numpy") == 1
    assert all(f" {name} " in f" {printed} " for name in listed)


def test_a_cache_that_cannot_be_written_is_one_sentence_or_not_needed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", "/proc/nix")
    monkeypatch.delenv("MPLCONFIGDIR", raising=False)
    failed = _fmus("build", "RecedingHorizonPlanner", "-d", str(tmp_path))
    assert failed.returncode == 2
    (only,) = failed.stderr.splitlines()
    assert only.startswith("fmus: the cache folder /proc/nix/")
    assert only.endswith("or name another place in XDG_CACHE_HOME")
    done = _fmus("build", "Imu", "-d", str(tmp_path))
    assert (done.returncode, done.stderr) == (0, "")


def test_build_makes_the_named_fmu(tmp_path: Path) -> None:
    done = _fmus("build", "Imu", "-d", str(tmp_path))
    assert (done.returncode, done.stdout, done.stderr) == (0, f"{tmp_path / 'Imu.fmu'}\n", "")
    assert [path.name for path in tmp_path.iterdir()] == ["Imu.fmu"]


def test_platforms_may_follow_one_another(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    seen = []

    def build(component: Component, _directory: Path, platforms: list[str], *, bundle: bool) -> None:
        seen.append((component, platforms))

    monkeypatch.setattr("fmukit.packaging.builder.build", build)
    for arguments in (
        ["--platform", "linux64", "win64", "Imu"],
        ["Imu", "--platform", "linux64", "--platform", "win64"],
    ):
        with pytest.raises(SystemExit) as end:
            run(APPLICATION, ["build", *arguments, "-d", str(tmp_path)])
        assert end.value.code == 0
    assert [(component.interface.name, platforms) for component, platforms in seen] == [
        ("Imu", ["linux64", "win64"])
    ] * 2


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
    (only,) = done.stderr.splitlines()
    assert only.startswith("fmus: ")
    assert words in only


@pytest.mark.parametrize("arguments", [["--help"], ["list"], ["check", "--help"], ["lst"]])
def test_nothing_heavy_is_imported_to_say_what_there_is(arguments: list[str]) -> None:
    done = subprocess.run(
        [sys.executable, "-X", "importtime", "-m", "fmus", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    imported = {line.rpartition("|")[2].strip().partition(".")[0] for line in done.stderr.splitlines()}
    assert "fmukit" in imported
    assert not imported & {"casadi", "numpy", "scipy", "matplotlib", "pyarrow", "fmpy", "osqp", "pydantic"}


@pytest.mark.parametrize("subcommand", APPLICATION.subcommands, ids=lambda subcommand: subcommand.name)
def test_the_line_in_the_table_begins_the_help_of_the_subcommand(subcommand: Subcommand) -> None:
    own = (loaded(subcommand.function).__doc__ or "").partition("\n")[0]
    assert own.startswith(subcommand.help.rstrip("."))
