"""Another FMU made with PythonFMU that embeds modules of the same names as the FMU under test."""

from __future__ import annotations

import re
from pathlib import Path
from shutil import copy2, copytree

from fmukit.conformance.bare import host
from fmukit.conformance.bench import PLATFORM, Bench

_HASHED = re.compile(r"(?=[0-9a-f]*\d)[0-9a-f]{8,}")
_SCRIPT = "stranger_5f0c7a91"
_SLAVE = """{imports}
from pythonfmu import Fmi2Slave


class Stranger(Fmi2Slave):
    def do_step(self, current_time, step_size):
        return True
"""


def namesakes(bench: Bench) -> list[str]:
    """Top-level modules embedded in the FMU whose names another FMU may well have: those without a content hash."""
    resources = bench.folder / "resources"
    scripts = {path.stem for path in resources.glob("*.py")}
    packages = {path.parent.name for path in resources.glob("*/__init__.py")}
    return sorted(name for name in scripts | packages - {"pythonfmu"} if not _HASHED.search(name))


def stranger(bench: Bench, folder: Path, names: list[str]) -> host.Target:
    """Make the other FMU in `folder`: the same host binary, empty modules of the given names."""
    place, suffix = PLATFORM
    resources, binaries = folder / "resources", folder / "binaries" / place
    binaries.mkdir(parents=True)
    library = binaries / f"Stranger{suffix}"
    copy2(bench.target.library, library)
    copytree(bench.folder / "resources" / "pythonfmu", resources / "pythonfmu")
    for name in names:
        (resources / f"{name}.py").write_text(f'"""The module {name} of another FMU."""\n', "utf-8")
    imports = "\n".join(f"import {name}" for name in names)
    (resources / f"{_SCRIPT}.py").write_text(_SLAVE.format(imports=imports), "utf-8")
    (resources / "slavemodule.txt").write_text(_SCRIPT, "utf-8")
    return host.Target(str(library), resources.resolve().as_uri(), "stranger", (), ())
