"""Scenarios as system files: what is written runs to the same bits."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from cosim.command.opening import opened
from cosim.model.parsing import parse_assignments
from cosim.results.reading import Results
from cosim.run.request import Request
from cosim.run.running import run
from cosim.scenario.definition import Scenario
from cosim.scenario.discovery import load, names
from cosim.system_file.writing import export_system

SHORT = {"collision-avoidance": 1.0, "arbitrary-path": 1.0}
LIGHT = {
    "formation-constraint": ("scenario.plant=unicycle",),
    "formation-adaptive": ("scenario.plant=unicycle",),
    "platoon": ("scenario.plant=unicycle",),
}


def ran(scenario: Scenario, folder: Path, *assignments: str) -> Results:
    request = Request(scenario, folder, parse_assignments(assignments), stop_time=SHORT.get(scenario.name, 0.5))
    finished = run(request)
    assert finished.summary.status in ("ok", "missed"), finished.summary.reason  # half a second is no mission
    return finished.results


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=() if name in ("lateral-tracking", "formation-constraint") else pytest.mark.nightly)
        for name in names()
    ],
)
def test_a_written_system_runs_to_the_same_bits(name: str, tmp_path: Path) -> None:
    own = ran(load(name), tmp_path / "own", *LIGHT.get(name, ()))
    request = Request(load(name), tmp_path, parse_assignments(LIGHT.get(name, ())))
    file = export_system(request, tmp_path / "system.toml")
    with opened(str(file)) as scenario:
        other = ran(scenario, tmp_path / "other")
    assert other.names == own.names
    for signal in own.names:
        np.testing.assert_array_equal(other[signal], own[signal], err_msg=signal)
