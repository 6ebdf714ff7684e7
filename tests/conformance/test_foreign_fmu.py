"""Every rule holds on a sound FMU that has the habits of FMUs made by other tools."""

from __future__ import annotations

import shutil
import sys
import zipfile
from pathlib import Path

import pytest
from small_fmu import SOURCES, compiled

from fmukit.conformance.running import run_groups

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux") or shutil.which("cc") is None, reason="needs Linux and a C compiler"
)
FOREIGN = SOURCES / "foreign"


def _fmu(folder: Path) -> Path:
    """The library of `sound_foreign.c` with the description and the resource that belong to it."""
    compiled(FOREIGN / "sound_foreign.c", folder)
    file = folder / "foreign.fmu"
    with zipfile.ZipFile(file, "w") as archive:
        archive.write(FOREIGN / "modelDescription.xml", "modelDescription.xml")
        archive.write(folder / "sound_foreign.so", "binaries/linux64/sound.so")
        archive.writestr("resources/table.txt", "0 0\n")
    return file


def test_habits_of_other_tools_break_no_rule(tmp_path: Path) -> None:
    findings = run_groups(_fmu(tmp_path))
    assert {f.rule.check.__name__: f.seen for f in findings if f.status == "fail"} == {}
    skipped = {f.rule.check.__name__ for f in findings if f.status == "skip"}
    assert {"several_at_once", "any_order"} <= skipped
    assert not {"round_trips", "start_values", "convergence", "percent"} & skipped
