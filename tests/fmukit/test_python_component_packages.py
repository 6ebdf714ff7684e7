"""What an FMU that needs casadi says in a host that has none, an old one or a broken one, and that it harms nobody."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import demo_search
import demo_spring
import pytest

from fmukit.packaging.builder import build

_RUN = """
import json, sys
from pathlib import Path
from fmu_driver import Instance

folder, state = Path(sys.argv[1]), bytes.fromhex(sys.argv[2])
instance = Instance(folder / "DemoSearch.fmu", folder / "search").initialise()
at_start = list(instance.messages)
steps = [instance.step(0.01) for _ in range(3)]
fault, outputs = instance["fault"], instance.outputs()
instance.fmu.serializeFMUstate(instance.fmu.getFMUstate())
instance.fmu.setFMUstate(instance.fmu.deSerializeFMUstate(state))
refused = instance.messages[-1]
steps += [instance.step(0.01)]
instance.fmu.reset()
steps += [instance.initialise().step(0.01)]
instance.free()
spring = Instance(folder / "DemoSpring.fmu", folder / "spring").initialise()
steps += [spring.step(0.01)]
spring.free()
print(json.dumps([at_start, steps, fault, refused]))
"""

CASADIS = {
    "missing": ("raise ModuleNotFoundError(\"No module named 'casadi'\", name='casadi')", "does not have"),
    "old": ("__version__ = '3.6.5'", "has 3.6.5"),
    "broken": ("raise ImportError('libcasadi.so: cannot open\\nshared object')", "cannot open shared object"),
    "half": ("import no_such_numpy", "cannot import (No module named 'no_such_numpy')"),
    "alien": ("", "cannot import"),
}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("fmus")
    for component in (demo_search.COMPONENT, demo_spring.COMPONENT):
        build(component, made)
    return made


@pytest.fixture(scope="module")
def state(folder: Path) -> str:
    """An FMU state from a host that has casadi."""
    program = (
        "import sys; from pathlib import Path; from fmu_driver import Instance\n"
        "i = Instance(Path(sys.argv[1]) / 'DemoSearch.fmu', Path(sys.argv[1]) / 'search').initialise()\n"
        "print(i.fmu.serializeFMUstate(i.fmu.getFMUstate()).hex()); i.free()"
    )
    return _python(program, str(folder)).strip()


def _python(program: str, *arguments: str, first: str = "") -> str:
    """What the program prints; `first` is a folder to look for modules in before all others."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join([first, os.environ.get("PYTHONPATH", "")])}
    line = [sys.executable, "-c", program, *arguments]
    done = subprocess.run(line, cwd=Path(__file__).parent, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("kind", CASADIS)
def test_it_says_so_once_and_discards_its_steps(folder: Path, state: str, tmp_path: Path, kind: str) -> None:
    text, words = CASADIS[kind]
    (tmp_path / "casadi.py").write_text(text)
    at_start, steps, fault, refused = json.loads(_python(_RUN, str(folder), state, first=str(tmp_path)))
    (sentence,) = at_start
    assert sentence.startswith("this FMU needs the Python package casadi")
    for needed in (words, sys.prefix, f'run: {sys.executable} -m pip install "casadi>=3.7"'):
        assert needed in sentence
    assert "\n" not in sentence
    assert steps == [False, False, False, False, False, True]
    assert fault == 1
    assert "could not be made" in refused
