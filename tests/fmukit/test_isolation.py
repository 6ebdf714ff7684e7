"""FMUs in one process: several kinds in any order, two versions of one, and many lives of one."""

from __future__ import annotations

import gc
import itertools
import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import demo_spring
import pytest
from fmu_driver import Instance

from fmukit.component import Component
from fmukit.packaging.builder import build

_RUN = """
import json, sys
from pathlib import Path
from fmu_driver import Instance

out = []
for number, file in enumerate(sys.argv[2:]):
    instance = Instance(Path(file), Path(sys.argv[1]) / f"{number}", "one").initialise()
    out.append([(instance.step(5e-3), instance.outputs()) for _ in range(5)])
    instance.free(remove=True)
print(json.dumps(out))
"""


def _values(folder: Path, files: list[Path]) -> list[object]:
    """Trajectories of the FMUs run one after the other in one fresh process, each unzipped and removed again."""
    arguments = [str(folder), *map(str, files)]
    done = subprocess.run(
        [sys.executable, "-c", _RUN, *arguments],
        cwd=Path(__file__).parent,
        capture_output=True,
        text=True,
        check=True,
    )
    values: list[object] = json.loads(done.stdout)
    return values


@pytest.fixture(scope="module")
def files(demo_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    """Two FMUs, and another version of the first under the same names."""
    interface = demo_spring.INTERFACE
    heavier = tuple(replace(v, start=4.0) if v.name == "mass" else v for v in interface.variables)
    component = Component(replace(interface, variables=heavier), "demo_spring")
    other = build(component, tmp_path_factory.mktemp("version2"))
    return [demo_folder / "DemoSpring.fmu", other, demo_folder / "DemoFilter.fmu"]


def test_any_order_in_one_process_gives_the_numbers_of_each_alone(files: list[Path], tmp_path: Path) -> None:
    alone = {file: _values(tmp_path, [file])[0] for file in files}
    assert alone[files[0]] != alone[files[1]]
    for order in itertools.permutations(files):
        sequence = [*order, *order]
        assert _values(tmp_path, sequence) == [alone[file] for file in sequence]


def test_both_versions_live_side_by_side(files: list[Path], tmp_path: Path) -> None:
    old, new = (Instance(file, tmp_path / f"{k}").initialise() for k, file in enumerate(files[:2]))
    assert (old["mass"], new["mass"]) == (2.0, 4.0)
    for _ in range(100):
        assert old.step(1e-3)
        assert new.step(1e-3)
    assert old["position"] != new["position"]
    old.free()
    assert new.step(1e-3)
    new.free()


def test_lives_leave_no_path_entry_no_library_and_no_crash(demo_folder: Path) -> None:
    path = list(sys.path)
    for life in range(300):
        instance = Instance(demo_folder / "DemoFilter.fmu", demo_folder / "lives").initialise({"seed": life})
        assert instance.step(5e-3)
        instance.free()
        if life % 10 == 0:
            gc.collect()
    assert sys.path == path
    if sys.platform == "linux":
        assert str(demo_folder / "lives" / "resources") not in Path("/proc/self/maps").read_text()


def test_library_stays_while_one_instance_needs_it(make: Callable[[str], Instance]) -> None:
    first, second = make("DemoSpring").initialise(), make("DemoSpring").initialise()
    first.fmu.reset()
    gc.collect()
    assert second.step(1e-3)
    assert first.initialise().step(1e-3)
