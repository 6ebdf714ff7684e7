"""What a run was made of: enough to tell it from every other run and to make it again."""

from __future__ import annotations

import json
import platform
import shlex
import subprocess
import sys
import textwrap
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import Any

from cosim.model.face import Value
from fmukit.compiling import compiler
from fmukit.errors import BuildError

PACKAGE = "vehicle-formation-fmus"
KEY = b"cosim"
"""The key of the metadata of results.parquet under which this stands as JSON."""
_WIDTH, _LINES = 110, 3
_TOOLS = ("fmpy", "pythonfmu", "casadi", "osqp", "numpy", "scipy", "pyarrow")


@dataclass(frozen=True, slots=True)
class Model:
    """An FMU that took part: its `file`, the SHA-256 of that, and the `tool` that made it."""

    file: str
    sha256: str
    tool: str


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where the results come from; its keys in summary.json are the names of these fields.

    settings  of the scenario, all of them, by name
    set       what was given by --set, as "instance.variable=value"
    at        what was given by --at, as "time:instance.input=value"
    periods   what was given by --period, as "instance=seconds"
    events    the files of --events, as "file sha256"
    replaced  what was given by --replace, as "instance=file"
    faults    what changes signals, as "instance.input: effect"
    values    parameters and inputs that start with another value than their FMU says, by "instance.variable"
    seed      of all noise
    stop      when the run was to end [s], None if that is not known
    scheme    "multirate" or "jacobi"
    step      the one communication step for all [s], None where each instance has its own
    models    the FMUs by the name of the model
    versions  of this package, of its git commit where there is one, of Python, the compiler and the libraries
    """

    settings: Mapping[str, Value] = field(default_factory=dict)
    set: Sequence[str] = ()
    at: Sequence[str] = ()
    periods: Sequence[str] = ()
    events: Sequence[str] = ()
    replaced: Sequence[str] = ()
    faults: Sequence[str] = ()
    values: Mapping[str, Value] = field(default_factory=dict)
    seed: int = 0
    stop: float | None = None
    scheme: str = "multirate"
    step: float | None = None
    models: Mapping[str, Model] = field(default_factory=dict)
    versions: Mapping[str, str] = field(default_factory=dict)

    def data(self) -> dict[str, Any]:
        """Plain values as JSON has them."""
        listed = ("set", "at", "periods", "events", "replaced", "faults")
        return asdict(self) | {key: list(getattr(self, key)) for key in listed}

    def json(self) -> str:
        """As JSON text, the same for equal runs wherever their results are written."""
        return json.dumps(self.data(), sort_keys=True)

    def text(self) -> str:
        """What the user chose, as the lines of a title; empty where nothing was."""
        chosen = [*self.set, *(f"at {event}" for event in self.at), *self.replaced]
        chosen += [f"events {file.partition(' ')[0]}" for file in self.events]
        chosen += [f"seed {self.seed}"] if self.seed else []
        chosen += [f"scheme {self.scheme}"] if self.scheme != "multirate" else []
        chosen += [f"step {self.step:g} s"] if self.step is not None else []
        return lines_of_title(" ".join(chosen))


def lines_of_title(text: str) -> str:
    """The text in a few lines that fit over a picture."""
    return textwrap.fill(textwrap.shorten(text, _LINES * _WIDTH, placeholder=" ..."), _WIDTH)


def command_line() -> str:
    """How this process was started, as a shell would take it."""
    name = Path(sys.argv[0]).name
    return shlex.join(["cosim" if name == "__main__.py" else name, *sys.argv[1:]])


@cache
def versions() -> dict[str, str]:
    """The versions of everything that can change results."""
    found = {PACKAGE: _version(PACKAGE), "git": _git(), "python": platform.python_version(), "compiler": _compiler()}
    return found | {tool: _version(tool) for tool in _TOOLS}


def _version(package: str) -> str:
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return ""


def _git() -> str:
    """The git commit of this code with "-dirty" if it was changed, empty outside a checkout."""
    root = Path(__file__).resolve().parents[2]
    if not (root / ".git").exists():
        return ""
    command = ["git", "-C", str(root), "describe", "--always", "--dirty", "--abbrev=12"]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True, timeout=5).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return ""


def _compiler() -> str:
    """The first line of the compiler's own version; empty where there is none, as a warm cache needs none."""
    try:
        lines = compiler.identity(compiler.host_platform()).splitlines()
    except BuildError:
        return ""
    own = len(compiler.command(compiler.host_platform())) + len(compiler.flags(compiler.host_platform()))
    return lines[own] if len(lines) > own else ""
