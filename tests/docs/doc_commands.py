"""Commands of the documents: how they are run, and what is run in place of those that take long."""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from functools import cache
from pathlib import Path

from doc_pages import ROOT

OURS = ("fmus", "cosim")
_CHEAP = (
    # 0.2 s load, wire, step and record all that a whole run does; events come early enough for that
    (r"^(cosim run .*) --stop-time \S+", r"\1"),
    (r"^cosim run .*", r"\g<0> --stop-time 0.2 --no-report"),
    (r"--at (['\"]?)[\d.]+:", r"--at \g<1>0.1:"),
    # one FMU stands for all, and the rules that read for those that run it: other tests build and check every FMU
    (r"^fmus build ((?:--crosscheck )?-d \S+)$", r"fmus build Imu \1"),
    (r"^(fmus check .*\.fmu)$", r"\1 --groups AX"),
    # the other platform needs a package that takes minutes at its first use
    (r"^(fmus build \S+) --platform .*", r"\1"),
    # a package of the reader's, beside the documents; this environment stays as it is
    (r"^pip install \.$", "pip install --quiet --no-index --no-deps --no-build-isolation --target site ."),
    # what is asked for is there
    (r"^pip install (?!--quiet)", r"pip install --quiet --no-index "),
)
_LONG = re.compile(r"python -m benchmarks|fmus plan collision-avoidance")


def lines(script: str) -> list[str]:
    """The commands of a block, one a line, without comments and blank lines; a backslash at its end joins two."""
    rows = (re.sub(r"(^|\s+)#\s.*", "", row).strip() for row in script.replace("\\\n", " ").splitlines())
    return [row for row in rows if row]


def cheap(command: str) -> str:
    """What is run in place of `command`: the same, shorter."""
    for pattern, shorter in _CHEAP:
        command = re.sub(pattern, shorter, command)
    return command


def takes_long(command: str) -> bool:
    """Whether it is left to the nightly tests."""
    return bool(_LONG.match(command))


def executed(command: str, folder: Path) -> str:
    """Run the shorter form of a command in `folder`; what went wrong, or ""."""
    if command.startswith("pytest"):
        return tests_missing(command)
    line = ["bash", "-euo", "pipefail", "-c", cheap(command)]
    done = subprocess.run(line, cwd=folder, env=_environment(folder), capture_output=True, text=True, check=False)
    return "" if done.returncode == 0 else f"`{command}` ends with {done.returncode}: {done.stderr or done.stdout}"


def unknown(command: str) -> str:
    """What `fmus` or `cosim` does not know of a command, which may hold names in capitals; or ""."""
    program, *words = shlex.split(command.partition(" -- ")[0])
    sub = [word for word in words[:1] if not word.startswith("-")]
    shown = help_of(program, *sub)
    if not shown:
        return f"`{command}`: there is no command {' '.join([program, *sub])}"
    missing = [word for word in words if re.match(r"--?[a-z]", word) and not re.search(rf"{word}\b", shown)]
    return f"`{command}`: {program} {' '.join(sub)} has no option {', '.join(missing)}" if missing else ""


def tests_missing(command: str) -> str:
    """What a `pytest` command names that is not there, or ""; the suite runs the tests themselves.

    Each word of a `-k` expression has to be in the name of a test, or of its file, in the places named.
    """
    words = shlex.split(command)[1:]
    options = {words[i]: words[i + 1] for i in range(len(words) - 1) if words[i] in ("-k", "-m", "-n")}
    places = [word for word in words if not word.startswith("-") and word not in options.values()]
    absent = [place for place in places if not (ROOT / place).exists()]
    if absent:
        return f"`{command}`: there is no {', '.join(absent)}"
    names = "\n".join(_tests(ROOT / place) for place in places or ["tests"])
    lost = [word for word in options.get("-k", "").split(" or ") if word not in names]
    return f"`{command}`: no test is named {', '.join(lost)}" if lost else ""


@cache
def help_of(*command: str) -> str:
    """What `command --help` prints; "" when there is no such command."""
    done = subprocess.run([*command, "--help"], env=_environment(), capture_output=True, text=True, check=False)
    return done.stdout if done.returncode == 0 else ""


@cache
def _tests(place: Path) -> str:
    files = [place] if place.is_file() else sorted(place.rglob("test_*.py"))
    found = ((file.stem, re.findall(r"def (test_\w+)", file.read_text("utf-8"))) for file in files)
    return "\n".join(f"{stem} {name}" for stem, names in found for name in names)


def _environment(folder: Path = ROOT) -> dict[str, str]:
    """That of this process, with the scripts of this interpreter first on the path.

    The checkout can be imported, and what a page installs into `folder`.
    """
    path = os.pathsep.join((str(Path(sys.executable).parent), os.environ.get("PATH", "")))
    modules = os.pathsep.join((str(ROOT), str(folder / "site")))
    return {**os.environ, "PATH": path, "PYTHONPATH": modules, "COLUMNS": "200"}
