"""Every FMU in a host written in C, which knows nothing of Python: run, faulted and freed many times over."""

from __future__ import annotations

import os
import subprocess
import sys
import zipfile
from pathlib import Path
from xml.etree import ElementTree

import pytest

from fmukit.component import Component
from fmukit.hosting.environment import environment
from fmukit.packaging.cached import cached
from fmus import CATALOGUE

CYCLES = 100
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the host is written for Linux")


@pytest.fixture(scope="module")
def host(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("c_host") / "host"
    source = Path(__file__).with_name("host.c")
    subprocess.run(["cc", "-std=c11", "-O1", "-Wall", "-Werror", "-o", made, source, "-ldl", "-lm"], check=True)
    return made


@pytest.fixture(scope="module")
def arguments(tmp_path_factory: pytest.TempPathFactory) -> dict[str, list[str]]:
    """What the host must know of each FMU."""
    folder = tmp_path_factory.mktemp("unzipped with spaces")
    return {component.interface.name: _arguments(component, folder) for component in CATALOGUE}


def _arguments(component: Component, parent: Path) -> list[str]:
    name = component.interface.name
    folder = parent / name
    with zipfile.ZipFile(cached(component)) as archive:
        archive.extractall(folder)
    root = ElementTree.parse(folder / "modelDescription.xml").getroot()
    variables = list(root.iter("ScalarVariable"))
    reals = [v for v in variables if v.find("Real") is not None]
    (fault,) = (v.attrib["valueReference"] for v in variables if v.get("name") == "fault")
    first = {
        cause: next((v.attrib["valueReference"] for v in reals if v.get("causality") == cause), "-1")
        for cause in ("input", "output")
    }
    binary = folder / "binaries" / "linux64" / f"{name}.so"
    resources = (folder / "resources").as_uri()
    step = str(component.interface.step)
    return [str(binary), root.attrib["guid"], resources, step, first["input"], fault, first["output"]]


def foreign() -> dict[str, str]:
    """The environment `fmus host` gives a host that is not Python, and nothing else of Python's."""
    return environment({key: value for key, value in os.environ.items() if not key.startswith("PYTHON")})


def run(host: Path, cycles: int, *fmus: list[str]) -> str:
    """The last line the host printed; fails with what it said if it did not end in peace."""
    line = [str(host), str(cycles), *(argument for fmu in fmus for argument in fmu)]
    done = subprocess.run(line, env=foreign(), capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, f"{done.returncode}: {done.stdout[-500:]} {done.stderr[-2000:]}"
    return done.stdout.splitlines()[-1]


@pytest.mark.parametrize("name", [component.interface.name for component in CATALOGUE])
def test_run_fault_free_a_hundred_times(host: Path, arguments: dict[str, list[str]], name: str) -> None:
    assert run(host, CYCLES, arguments[name]) == f"done: 1 FMUs, {CYCLES} cycles"


def test_all_of_them_in_one_process(host: Path, arguments: dict[str, list[str]]) -> None:
    assert run(host, 20, *arguments.values()) == f"done: {len(CATALOGUE)} FMUs, 20 cycles"


def test_what_goes_wrong_is_told(host: Path, arguments: dict[str, list[str]]) -> None:
    """The host itself: with the reference of something else for the fault, it stops at the first check of the fault."""
    *others, _, output = arguments["Imu"]
    with pytest.raises(AssertionError, match="cycle 0: no fault after a refused call"):
        run(host, 1, [*others, output, output])


def test_a_package_that_is_missing_costs_steps_and_not_the_host(
    host: Path, arguments: dict[str, list[str]], tmp_path: Path
) -> None:
    """The planner in an interpreter without casadi: the host sees a discarded step, stops for it, and ends in peace."""
    (tmp_path / "casadi.py").write_text("raise ModuleNotFoundError(\"No module named 'casadi'\", name='casadi')\n")
    line = [str(host), "3", *arguments["RecedingHorizonPlanner"]]
    variables = foreign() | {"PYTHONPATH": str(tmp_path)}
    done = subprocess.run(line, env=variables, capture_output=True, text=True, timeout=120, check=False)
    assert (done.returncode, done.stderr) == (1, "")
    assert "RecedingHorizonPlanner" in done.stdout
    assert done.stdout.endswith("cycle 0: no step\n")
