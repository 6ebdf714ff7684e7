"""Cross-check bundles: within the rules of the format, and reproduced by the FMU in FMPy from the files alone."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import demo_spring
import fmpy
import fmpy.util
import numpy as np
import pytest

from fmukit.component import Component
from fmukit.errors import BuildError
from fmukit.packaging import crosscheck
from fmukit.packaging.builder import build
from fmukit.packaging.cached import cached
from fmukit.packaging.recording import Recording, recorded
from fmukit.reference_run import ReferenceRun
from fmus import CATALOGUE

ROOT = Path(__file__).parents[2]
every_component = pytest.mark.parametrize("component", CATALOGUE, ids=lambda component: component.interface.name)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bundles of the whole catalogue."""
    made = tmp_path_factory.mktemp("bundles")
    for component in CATALOGUE:
        recording = recorded(component, component.kernel())
        assert recording is not None, f"{component.interface.name} has no reference run"
        for name, data in crosscheck.bundle(component.interface.name, recording).items():
            (made / name).write_bytes(data)
    return made


def _options(path: Path) -> dict[str, float]:
    return {key: float(value) for key, value in csv.reader(path.read_text().splitlines())}


def _columns(path: Path) -> dict[str, np.ndarray]:
    with path.open(newline="") as file:
        head, *rows = csv.reader(file)
    return dict(zip(head, np.array(rows, dtype=float).T, strict=True))


def _worst(found: np.ndarray, expected: dict[str, np.ndarray]) -> float:
    """Largest difference of any signal relative to the signal's largest value."""
    return max(
        float(np.abs(found[name] - values).max()) / max(float(np.abs(values).max()), 1e-9)
        for name, values in expected.items()
    )


def _simulate(component: Component, folder: Path, signals: np.ndarray | None, names: list[str]) -> np.ndarray:
    options = _options(folder / f"{component.interface.name}_ref.opt")
    return fmpy.simulate_fmu(
        str(cached(component)),
        start_time=options["StartTime"],
        stop_time=options["StopTime"],
        output_interval=options["StepSize"],
        input=signals,
        output=[name for name in names if name != "time"],
    )


def _signals(path: Path) -> np.ndarray | None:
    return fmpy.util.read_csv(str(path)) if path.is_file() else None


@every_component
def test_the_fmu_reproduces_its_reference(component: Component, folder: Path) -> None:
    name = component.interface.name
    expected = _columns(folder / f"{name}_ref.csv")
    found = _simulate(component, folder, _signals(folder / f"{name}_in.csv"), list(expected))
    assert len(found) == len(expected["time"])
    assert _worst(found, expected) <= _options(folder / f"{name}_ref.opt")["RelTol"]
    moving = [signal for signal, values in expected.items() if np.ptp(values) > 0]
    assert len(moving) > len(expected) / 4


def test_other_inputs_give_another_result(folder: Path) -> None:
    component = next(c for c in CATALOGUE if c.interface.name == "Imu")
    expected = _columns(folder / "Imu_ref.csv")
    signals = _signals(folder / "Imu_in.csv")
    assert signals is not None
    signals["truth.angular_rate.z"] *= 1.001
    assert _worst(_simulate(component, folder, signals, list(expected)), expected) > 1e-4


@every_component
def test_files_keep_the_rules(component: Component, folder: Path) -> None:
    name, interface = component.interface.name, component.interface
    assert (folder / f"{name}_in.csv").is_file() == bool(interface.select("input"))
    for causality, path in (("input", folder / f"{name}_in.csv"), ("output", folder / f"{name}_ref.csv")):
        if not path.is_file():
            continue
        data = path.read_bytes()
        assert len(data) <= 1_000_000
        lines = data.decode("ascii").split("\n")
        assert lines.pop() == ""
        assert lines[0] == ",".join(f'"{name}"' for name in ("time", *interface.names(causality)))
        assert not [line for line in lines if line.endswith((",", ";", " ")) or ('"' in line and line is not lines[0])]
        columns = _columns(path)
        assert all(np.isfinite(values).all() for values in columns.values())
        assert (np.diff(columns["time"]) > 0).all()
        options = _options(folder / f"{name}_ref.opt")
        assert columns["time"][0] == options["StartTime"]
        assert columns["time"][-1] == options["StopTime"]
        assert np.allclose(np.diff(columns["time"]), options["StepSize"])
    assert list(options) == ["StartTime", "StopTime", "StepSize", "RelTol"]
    readme = (folder / f"{name}_readme.txt").read_text()
    assert readme.startswith(name)
    assert (f"{name}_in.csv" in readme) == bool(interface.select("input"))
    assert f"{name}_ref.csv" in readme


@every_component
def test_inputs_of_the_reference_run_are_within_their_limits(component: Component, folder: Path) -> None:
    path = folder / f"{component.interface.name}_in.csv"
    columns = _columns(path) if path.is_file() else {}
    for variable in component.interface.select("input"):
        values = columns[variable.name]
        assert variable.minimum is None or values.min() >= variable.minimum
        assert variable.maximum is None or values.max() <= variable.maximum


def test_command_writes_the_bundle_beside_the_fmu(tmp_path: Path) -> None:
    line = [sys.executable, "-m", "fmus", "build", "Imu", "--crosscheck", "-d", str(tmp_path)]
    subprocess.run(line, cwd=ROOT, check=True, capture_output=True)
    expected = ["Imu.fmu", "Imu_in.csv", "Imu_readme.txt", "Imu_ref.csv", "Imu_ref.opt"]
    assert sorted(path.name for path in tmp_path.iterdir()) == expected
    component = next(c for c in CATALOGUE if c.interface.name == "Imu")
    again = build(component, tmp_path / "elsewhere", bundle=True).parent
    assert all((again / name).read_bytes() == (tmp_path / name).read_bytes() for name in expected)


def test_component_without_a_reference_run_gets_no_bundle(tmp_path: Path) -> None:
    build(demo_spring.COMPONENT, tmp_path, bundle=True)
    assert [path.name for path in tmp_path.iterdir()] == ["DemoSpring.fmu"]


def test_too_long_a_run_is_refused_in_one_sentence() -> None:
    run, times = ReferenceRun("Long.", stop=100.0, step=1e-3, plots={}), np.arange(100_001) * 1e-3
    recording = Recording(run, times, {}, {"speed": np.sin(times)})
    with pytest.raises(BuildError, match=r"DemoSpring_ref.csv has \d+ bytes, more than 1 MB; give .* a longer step"):
        crosscheck.bundle("DemoSpring", recording)
