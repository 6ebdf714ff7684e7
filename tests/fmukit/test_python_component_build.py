"""What travels in an FMU that is a Python module, and what the build refuses to let travel."""

from __future__ import annotations

import sys
import zipfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from shutil import copytree

import demo_search
import demo_spring
import pe_file
import pytest
from demo_search import model

from fmukit import store
from fmukit.compiling import compiler
from fmukit.compiling.functions import library
from fmukit.component import Component
from fmukit.errors import BuildError
from fmukit.packaging.builder import build
from fmukit.packaging.crosscheck import bundle
from fmukit.packaging.python_module import embedded, modules
from fmukit.packaging.recording import record
from fmukit.packaging.sources import fingerprint
from fmukit.python_kernel import PythonKernel, packages
from fmukit.reference_run import ReferenceRun

SOURCE = Path(demo_search.__file__).parent
RUN = ReferenceRun("It follows a moving target.", 0.05, 0.01, {"point": ("nearest.x", "nearest.y")})


@pytest.fixture(scope="module")
def members(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return _members(build(demo_search.COMPONENT, tmp_path_factory.mktemp("built")))


def _members(file: Path) -> dict[str, bytes]:
    with zipfile.ZipFile(file) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


@pytest.fixture
def copied(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The demo's package under another name, to be changed."""
    folder = copytree(SOURCE, tmp_path / "demo_copy", ignore=lambda *_: ["__pycache__"])
    for path in folder.rglob("*.py"):
        path.write_text(path.read_text().replace("demo_search", "demo_copy"))
    monkeypatch.syspath_prepend(tmp_path)
    yield folder
    for name in [name for name in sys.modules if name.partition(".")[0] == "demo_copy"]:
        del sys.modules[name]


def _component() -> Component:
    return Component(demo_search.INTERFACE, "demo_copy.model", ("casadi",))


def test_it_brings_the_modules_it_imports_and_nothing_else(members: dict[str, bytes]) -> None:
    inside = {name.partition("/model/")[2]: data for name, data in members.items() if "/model/" in name}
    assert inside.keys() == {"__init__.py", "run.py", "shape.py", "helpers/__init__.py", "helpers/levels.py"}
    assert inside["__init__.py"] == inside["helpers/__init__.py"] == b""
    assert inside["helpers/levels.py"] == (SOURCE / "helpers" / "levels.py").read_bytes()
    assert [name for name in members if name.endswith("/hyperbola.so")]


def test_same_sources_give_the_same_bytes(tmp_path: Path) -> None:
    one, other = (build(demo_search.COMPONENT, tmp_path / name).read_bytes() for name in "ab")
    assert one == other


def test_another_helper_is_another_fmu(copied: Path, tmp_path: Path) -> None:
    one, before = build(_component(), tmp_path / "a"), fingerprint(_component())
    helper = copied / "helpers" / "levels.py"
    helper.write_text(helper.read_text() + "\n\nLATER = 1\n")
    other = build(_component(), tmp_path / "b")
    assert fingerprint(_component()) != before
    assert _package(one) != _package(other)


def _package(file: Path) -> str:
    return next(name for name in _members(file) if name.endswith("interface.json"))


@pytest.mark.parametrize("share", [0.5, 0.97])
def test_a_damaged_library_does_not_travel(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, share: float) -> None:
    monkeypatch.setattr(store, "cache_folder", lambda: tmp_path)
    kernel, platform = demo_search.COMPONENT.kernel(), compiler.host_platform()
    path = library(kernel.libraries["hyperbola"], "hyperbola", platform)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    assert embedded(kernel, [platform]).files["hyperbola.so"] == data


def test_what_the_host_needs_is_written_everywhere(members: dict[str, bytes], tmp_path: Path) -> None:
    assert members["resources/requirements.txt"] == b"casadi>=3.7\n"
    assert b"a Python 3 interpreter with casadi 3.7 or newer." in members["documentation/index.html"]
    kernel = demo_search.COMPONENT.kernel()
    recording = record(demo_search.COMPONENT, kernel, RUN)
    readme = bundle("DemoSearch", recording, packages(kernel))["DemoSearch_readme.txt"].decode()
    assert "The host needs a Python 3 interpreter with casadi 3.7 or newer it can find." in readme
    assert recording.outputs["nearest.x"][-1] == pytest.approx(2.926, abs=1e-3)
    plain = _members(build(demo_spring.COMPONENT, tmp_path))
    assert plain["resources/requirements.txt"] == b""
    assert b"and no Python packages" in plain["documentation/index.html"]


def test_what_an_output_depends_on_at_the_start_is_left_open(members: dict[str, bytes]) -> None:
    unknowns = members["modelDescription.xml"].decode().partition("<InitialUnknowns>")[2]
    assert "Unknown" in unknowns
    assert "dependencies" not in unknowns


def test_a_component_names_the_packages_of_its_kernel(tmp_path: Path) -> None:
    silent = Component(demo_search.INTERFACE, "demo_search.model")
    with pytest.raises(BuildError, match=r"DemoSearch names the packages \[\], but its kernel needs \['casadi'\]"):
        build(silent, tmp_path)


IMPORTS = {
    "import demo_search.shape": "imports demo_search.shape, which an FMU will not find",
    "import fmukit.units": "imports fmukit.units",
    "from scipy import optimize": "imports scipy",
    "def f():\n    import numpy": "only the standard library and casadi",
    "from . import nowhere": "the module demo_copy.nowhere does not exist",
    "from .nowhere import x": "the module demo_copy.nowhere does not exist",
    "from . import helpers": "demo_copy.helpers is a package",
    "from ..shape import ROWS": "leaves the package",
    "if True:\n    from .shape import ROWS\n    import osqp": "line 5: imports osqp",
}


@pytest.mark.parametrize("text", IMPORTS)
def test_imports_that_would_fail_in_the_fmu_are_refused(copied: Path, text: str) -> None:
    (copied / "run.py").write_text(f'"""Changed."""\n\n{text}\n')
    with pytest.raises(BuildError) as error:
        modules(PythonKernel("demo_copy.run", states=0))
    assert IMPORTS[text] in str(error.value)
    assert str(error.value).count("\n") == 0


def test_the_kernels_packages_and_all_depths_may_be_imported(copied: Path) -> None:
    (copied / "helpers" / "levels.py").write_text("import os.path\nimport numpy as np\nfrom .. import shape\n")
    (copied / "run.py").write_text("from collections import abc\nfrom casadi import SX\nfrom .helpers import levels\n")
    kernel = PythonKernel("demo_copy.run", states=0, packages={"casadi": "3.7", "numpy": "1.26"})
    assert list(modules(kernel)) == ["demo_copy.run", "demo_copy.helpers.levels", "demo_copy.shape"]
    assert embedded(kernel, ["linux64"]).modules == ["model.run", "model.helpers.levels", "model.shape"]


@pytest.mark.nightly
@pytest.mark.skipif(find_spec("ziglang") is None, reason="needs the extra zig")
def test_the_library_is_compiled_for_windows_too() -> None:
    """With the functions casadi looks up, and without need of casadi's own libraries."""
    made = pe_file.read(embedded(model.kernel(), ["win64"]).files["hyperbola.dll"])
    assert {"nlp", "nlp_f", "nlp_g", "nlp_grad_f", "nlp_jac_g", "nlp_hess_l", "nlp_work"} <= set(made.exports)
    needed = [name.lower() for name in made.imports]
    assert [n for n in needed if n != "kernel32.dll" and not n.startswith("api-ms-win-crt-")] == []
