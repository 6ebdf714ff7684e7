"""FMU files: valid, complete, reproducible to the byte, built only when needed, and clear about what is missing."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path
from xml.etree import ElementTree

import demo_filter
import demo_spring
import fmpy.validation
import pytest

import fmukit
from fmukit import store
from fmukit.compiling import compiler
from fmukit.errors import BuildError
from fmukit.packaging.builder import build
from fmukit.packaging.cached import cached

ROOT = Path(__file__).parents[2]


@pytest.fixture
def no_memory() -> Iterator[None]:
    """Forget which compiler was found, before and after."""
    compiler.command.cache_clear()
    compiler.identity.cache_clear()
    yield
    compiler.command.cache_clear()
    compiler.identity.cache_clear()


@pytest.mark.parametrize("model", ["DemoSpring", "DemoFilter"])
def test_validators_are_satisfied(demo_folder: Path, model: str) -> None:
    file = str(demo_folder / f"{model}.fmu")
    assert fmpy.validation.validate_fmu(file) == []
    tool = Path(sysconfig.get_path("scripts")) / "fmutool"
    done = subprocess.run([str(tool), "-input", file, "-check"], capture_output=True, text=True, check=True)
    said = done.stdout + done.stderr
    assert "compliant with FMI-2.0" in said
    assert "No semantic error" in said
    assert not [line for line in said.splitlines() if line.startswith(("WARNING", "ERROR", "CRITICAL"))]


def test_builds_in_two_folders_are_identical(demo_folder: Path, tmp_path: Path) -> None:
    for component in (demo_spring.COMPONENT, demo_filter.COMPONENT):
        again = build(component, tmp_path / "elsewhere")
        assert again.read_bytes() == (demo_folder / again.name).read_bytes()


def test_nothing_of_the_builder_is_left_behind(tmp_path: Path) -> None:
    modules, path = set(sys.modules), list(sys.path)
    build(demo_spring.COMPONENT, tmp_path)
    assert sys.path == path
    assert not {name for name in set(sys.modules) - modules if name.startswith(("fmu_", "demospring"))}


def test_archive_holds_no_local_path_and_only_its_platform(demo_folder: Path) -> None:
    with zipfile.ZipFile(demo_folder / "DemoFilter.fmu") as archive:
        members = {name: archive.read(name) for name in archive.namelist()}
    assert {name.split("/")[1] for name in members if name.startswith("binaries/")} == {compiler.host_platform()}
    assert members["resources/requirements.txt"] == b""
    assert {name for name in members if name.startswith("documentation/licenses/")}
    own = [data for name, data in members.items() if not name.startswith("binaries/")]
    for place in (b"/tmp/", str(ROOT).encode(), str(Path.home()).encode() + b"/"):
        assert not any(place in data for data in own)


def test_library_shows_only_the_kernel_functions(demo_folder: Path, tmp_path: Path) -> None:
    if shutil.which("nm") is None:
        pytest.skip("needs nm")
    with zipfile.ZipFile(demo_folder / "DemoSpring.fmu") as archive:
        (member,) = (name for name in archive.namelist() if name.endswith("kernel.so"))
        archive.extract(member, tmp_path)
    done = subprocess.run(["nm", "-D", "--defined-only", tmp_path / member], capture_output=True, text=True, check=True)
    shown = {line.split()[-1] for line in done.stdout.splitlines()}
    assert shown == {"fmukit_initialise", "fmukit_advance", "fmukit_normals", "fmukit_size", "fmukit_store"}


def _xml(path: Path) -> ElementTree.Element:
    with zipfile.ZipFile(path) as archive:
        return ElementTree.fromstring(archive.read("modelDescription.xml"))


def test_description_is_complete(demo_folder: Path) -> None:
    root = _xml(demo_folder / "DemoFilter.fmu")
    assert root.attrib["generationDateAndTime"].endswith("Z")
    assert root.attrib["version"] == fmukit.__version__
    variables = {v.attrib["name"]: v for v in root.iter("ScalarVariable")}
    assert [v.attrib["valueReference"] for v in variables.values()] == [str(i) for i in range(len(variables))]
    assert variables["measured"][0].attrib == {"unit": "m", "min": "-1000000.0", "max": "1000000.0", "start": "0.0"}
    assert variables["measured"].attrib["variability"] == "discrete"
    assert variables["seed"][0].tag == "Integer"
    index = {name: str(i) for i, name in enumerate(variables, start=1)}
    outputs = {u.attrib["index"]: u.attrib["dependencies"] for u in root.iterfind("ModelStructure/Outputs/Unknown")}
    assert outputs == {index[n]: "" for n in ("filtered", "noise", "level", "quotient", "count", "fault")}
    initial = {
        u.attrib["index"]: u.attrib["dependencies"] for u in root.iterfind("ModelStructure/InitialUnknowns/Unknown")
    }
    assert initial.keys() == outputs.keys()
    assert initial[index["filtered"]] == f"{index['sigma']} {index['seed']}"
    assert initial[index["level"]] == index["profile_file"]


def test_dependencies_at_initialisation_are_those_of_the_equations(demo_folder: Path) -> None:
    root = _xml(demo_folder / "DemoSpring.fmu")
    names = [v.attrib["name"] for v in root.iter("ScalarVariable")]
    found = {
        names[int(u.attrib["index"]) - 1]: {names[int(i) - 1] for i in u.attrib["dependencies"].split()}
        for u in root.iterfind("ModelStructure/InitialUnknowns/Unknown")
    }
    assert found["position"] == {"initial.position"}
    assert found["energy"] == {"initial.position", "stiffness", "spring.enabled", "mass"}
    assert found["speed"] == found["fault"] == set()


def test_guid_and_package_follow_the_contents(demo_folder: Path) -> None:
    one, other = (_xml(demo_folder / f"{model}.fmu").attrib["guid"] for model in ("DemoSpring", "DemoFilter"))
    assert one != other
    with zipfile.ZipFile(demo_folder / "DemoSpring.fmu") as archive:
        script = archive.read("resources/slavemodule.txt").decode()
    assert one.strip("{}").replace("-", "").startswith(script.rpartition("_")[2])


def test_cached_fmu_is_reused_and_needs_no_casadi(tmp_path: Path) -> None:
    built = cached(demo_spring.COMPONENT, tmp_path)
    stamp = built.stat().st_mtime_ns
    program = (
        "import json, sys\n"
        "from pathlib import Path\n"
        "from fmukit.packaging.cached import cached\n"
        "from fmukit.component import Component\n"
        "from fmukit.interface import Interface, Variable, CsvTable\n"
        "from math import inf\n"
        f"path = cached(Component({demo_spring.INTERFACE!r}, 'demo_spring'), Path({str(tmp_path)!r}))\n"
        "print(json.dumps([str(path), 'casadi' in sys.modules]))\n"
    )
    paths = f"{ROOT}{':'}{Path(__file__).parent}"
    done = subprocess.run(
        [sys.executable, "-c", program],
        env={"PYTHONPATH": paths, "PATH": "/usr/bin:/bin"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert json.loads(done.stdout) == [str(built), False]
    assert built.stat().st_mtime_ns == stamp


def _cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def _flip(path: Path) -> None:
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 0xFF
    path.write_bytes(data)


def _empty(path: Path) -> None:
    path.write_bytes(b"")


@pytest.mark.parametrize("damage", [_cut, _flip, _empty])
def test_damaged_fmu_in_the_cache_is_built_anew(tmp_path: Path, damage: Callable[[Path], None]) -> None:
    good = cached(demo_spring.COMPONENT, tmp_path)
    data = good.read_bytes()
    damage(good)
    assert cached(demo_spring.COMPONENT, tmp_path) == good
    assert good.read_bytes() == data


def test_cache_that_cannot_be_written_is_one_sentence_with_the_remedy(tmp_path: Path) -> None:
    folder = tmp_path / "file" / "cache"
    folder.parent.write_text("in the way")
    with pytest.raises(BuildError, match=r"cache folder .*file/cache.* cannot be written \(.+\); .*XDG_CACHE_HOME"):
        cached(demo_spring.COMPONENT, folder)


@pytest.mark.parametrize(("chosen", "status"), [("false", 1), ("true", 0)])
def test_compiler_that_says_nothing_is_named_with_the_remedy(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, no_memory: None, chosen: str, status: int
) -> None:
    monkeypatch.setenv("CC", chosen)
    with pytest.raises(BuildError, match=rf"compiler {chosen} failed \(status {status}, .*\); correct or unset CC"):
        build(demo_spring.COMPONENT, tmp_path)


def test_missing_compiler_is_one_sentence_with_the_remedy(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, no_memory: None
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    monkeypatch.setattr(compiler, "find_spec", lambda name: None)
    with pytest.raises(BuildError, match=r"needs a C compiler: .*pip install ziglang"):
        build(demo_spring.COMPONENT, tmp_path)
    with pytest.raises(BuildError, match=r"to build for win64"):
        build(demo_spring.COMPONENT, tmp_path, ["win64"])
    with pytest.raises(BuildError, match=r"no platform amiga"):
        build(demo_spring.COMPONENT, tmp_path, ["amiga"])
    monkeypatch.setenv("CC", "no-such-compiler -m64")
    with pytest.raises(BuildError, match=r"CC=no-such-compiler -m64 does not exist"):
        build(demo_spring.COMPONENT, tmp_path)
    assert list(tmp_path.iterdir()) == []


def test_cache_forgets_what_is_a_month_old(tmp_path: Path) -> None:
    old, young, other = (tmp_path / name for name in ("DemoSpring-0", "DemoSpring-1", "Demo-0"))
    for made in (old, young, other):
        made.mkdir()
    for made in (old, other):
        os.utime(made, (1e9, 1e9))
    cached(demo_spring.COMPONENT, tmp_path)
    assert not old.exists()
    assert young.exists()
    assert other.exists()


def test_an_fmu_in_daily_use_is_never_forgotten(tmp_path: Path) -> None:
    used = cached(demo_spring.COMPONENT, tmp_path)
    os.utime(used.parent, (1e9, 1e9))
    assert cached(demo_spring.COMPONENT, tmp_path) == used
    store.prune(tmp_path / "DemoSpring-another")
    assert used.is_file()
