"""A user's package adds a scenario to the command by being installed, without a change to this project."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

NAME = "my_drives-1.0"
MODULE = """
from cosim.model.system import System
from cosim.scenario.definition import Scenario, Work
from cosim.scenario.metric import Metric

COAST = Scenario("coasting", "A unicycle coasts", "none", 1.0, "my_drives")


def build(settings, prepared):
    system = System()
    system.add("plant", "Unicycle", {"initial.speed": 12.0})
    return system


def metrics(results, prepared):
    return {"way": Metric(float(results["plant.position.x"][-1]), "m")}


WORK = Work(build, metrics=metrics)
"""
FILES = {
    "my_drives.py": MODULE,
    f"{NAME}.dist-info/METADATA": "Metadata-Version: 2.1\nName: my-drives\nVersion: 1.0\n",
    f"{NAME}.dist-info/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    f"{NAME}.dist-info/entry_points.txt": "[cosim.scenarios]\ncoasting = my_drives:COAST\nbroken = my_drives:NOTHING\n",
}


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment in which the package is installed: a wheel, by pip."""
    folder = tmp_path_factory.mktemp("package")
    wheel = folder / f"{NAME}-py3-none-any.whl"
    with zipfile.ZipFile(wheel, "w") as archive:
        for name, text in FILES.items():
            archive.writestr(name, text)
        archive.writestr(f"{NAME}.dist-info/RECORD", "".join(f"{name},,\n" for name in FILES))
    target = folder / "site"
    pip = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--no-index", "--target", str(target), str(wheel)]
    subprocess.run(pip, check=True, capture_output=True)
    return {**os.environ, "PYTHONPATH": str(target)}


def cosim(environment: dict[str, str], *arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    line = [sys.executable, "-m", "cosim", *arguments]
    return subprocess.run(line, env=environment, cwd=folder, capture_output=True, text=True, check=False)


def test_it_is_listed_and_runs(installed: dict[str, str], tmp_path: Path) -> None:
    done = cosim(installed, "run", "coasting", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "way" in done.stdout
    assert (tmp_path / "results" / "coasting" / "results.parquet").is_file()


def test_a_broken_one_is_one_sentence(installed: dict[str, str], tmp_path: Path) -> None:
    done = cosim(installed, "run", "broken", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.startswith("cosim: the scenario broken of my_drives:NOTHING cannot be loaded: ")
    assert done.stderr.count("\n") == 1


def test_the_list_goes_on_without_a_broken_one(installed: dict[str, str], tmp_path: Path) -> None:
    done = cosim(installed, "list", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "coasting" in done.stdout
    assert "high-speed-tracking" in done.stdout
    assert done.stderr.startswith("cosim: the scenario broken of my_drives:NOTHING cannot be loaded: ")
