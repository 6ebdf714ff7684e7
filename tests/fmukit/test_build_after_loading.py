"""Building in a process that has run an FMU: its copy of PythonFMU is then imported, and lacks the libraries."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

_PROGRAM = """
import shutil
import sys
from pathlib import Path

from fmu_driver import Instance

folder, source = Path(sys.argv[1]), Path(sys.argv[2])
instance = Instance(source, folder / "unpacked").initialise()
assert str(folder) in sys.modules["pythonfmu"].__file__, sys.modules["pythonfmu"].__file__
shutil.rmtree(folder / "unpacked")
import demo_filter
from fmukit.packaging.builder import build

build(demo_filter.COMPONENT, folder)
"""


def test_an_fmu_built_after_another_was_loaded_has_its_library(demo_folder: Path, tmp_path: Path) -> None:
    here = Path(__file__).parent
    line = [sys.executable, "-c", _PROGRAM, str(tmp_path), str(demo_folder / "DemoSpring.fmu")]
    paths = {"PYTHONPATH": f"{here}:{here.parents[1]}", "PATH": "/usr/bin:/bin:/usr/local/bin"}
    done = subprocess.run(line, env=paths, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr[-2000:]
    with zipfile.ZipFile(tmp_path / "DemoFilter.fmu") as made, zipfile.ZipFile(demo_folder / "DemoFilter.fmu") as usual:
        assert {n: made.read(n) for n in made.namelist()} == {n: usual.read(n) for n in usual.namelist()}
