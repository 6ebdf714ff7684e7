"""Rules of behaviour, continued: nothing grows while instances come and go."""

from __future__ import annotations

import gc
import os
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from time import monotonic

from fmukit.conformance.bench import Bench
from fmukit.conformance.rule import NotApplicable, Rules
from fmukit.guard.guarded import MARK
from fmukit.guard.keeper import processes

RULES: Rules[Bench] = Rules()
WARM_UP, CYCLES = 25, 60
LEAK = 16384.0
_PATIENCE = 4.0
_STEPS = 10
_PAGE = 4096
_ME = Path("/proc/self")


def use(bench: Bench, cycles: int, patience: float = _PATIENCE) -> int:
    """Instantiate, run and free that often, or for `patience` [s] if that is shorter; how often it was."""
    experiment = bench.experiment.until(_STEPS)
    began = monotonic()
    for cycle in range(cycles):
        bench.life(experiment)
        if cycle % 10 == 9:
            gc.collect()
        if monotonic() - began > patience:
            return cycle + 1
    return cycles


def measure(bench: Bench) -> dict[str, int]:
    """What may not grow; on systems other than Linux only what Python itself can tell."""
    gc.collect()
    places = (Path(tempfile.gettempdir()), Path.cwd(), bench.folder)
    found = {
        "path": len(sys.path),
        "files": sum(len(files) for place in dict.fromkeys(places) for *_, files in os.walk(place)),
    }
    if _ME.is_dir():
        found["memory"] = int((_ME / "statm").read_text().split()[1]) * _PAGE
        found["handles"] = len(os.listdir(_ME / "fd"))
        found["threads"] = len(os.listdir(_ME / "task"))
    return found


def _growth(bench: Bench, what: str) -> tuple[int, int]:
    """How much it grew, over how many cycles, after a warm-up."""
    growth, cycles = bench.remember("growth", lambda: _grow(bench))
    if what not in growth:
        raise NotApplicable("this can be measured on Linux only")
    return growth[what], cycles


def _grow(bench: Bench) -> tuple[dict[str, int], int]:
    use(bench, WARM_UP)
    before = measure(bench)
    cycles = use(bench, CYCLES)
    after = measure(bench)
    return {what: after[what] - before[what] for what in before}, cycles


def _none(bench: Bench, what: str, words: str) -> Iterator[str]:
    growth, cycles = _growth(bench, what)
    if growth >= max(1, cycles // 4):
        yield f"{cycles} lives of {_STEPS} steps left {growth} {words}"


@RULES.add(
    "B14",
    "Memory does not grow",
    "2.1.5",
    "free all memory of an instance in fmi2FreeInstance",
)
def memory(bench: Bench) -> Iterator[str]:
    growth, cycles = _growth(bench, "memory")
    if growth > LEAK * cycles:
        yield f"each life of {_STEPS} steps leaves {growth / cycles / 1024:.0f} kB behind, measured over {cycles} lives"


@RULES.add(
    "B15",
    "File handles are closed",
    "2.1.5",
    "close files, sockets and pipes no later than in fmi2FreeInstance",
)
def handles(bench: Bench) -> Iterator[str]:
    yield from _none(bench, "handles", "file handles open")


@RULES.add(
    "B16",
    "Threads end",
    "2.1.5",
    "stop and join the threads of an instance no later than in fmi2FreeInstance",
)
def threads(bench: Bench) -> Iterator[str]:
    yield from _none(bench, "threads", "threads running")


@RULES.add(
    "B17",
    "Python's module path does not grow",
    "good practice",
    "take entries the FMU puts into sys.path out again (PythonFMU adds one per instance and leaves it)",
)
def module_path(bench: Bench) -> Iterator[str]:
    if not bench.package.python:
        raise NotApplicable("it is not made with PythonFMU")
    yield from _none(bench, "path", "more entries in sys.path")


@RULES.add(
    "B18",
    "No files are left behind",
    "good practice",
    "delete temporary files no later than in fmi2FreeInstance, and write none into the working folder",
)
def files(bench: Bench) -> Iterator[str]:
    yield from _none(bench, "files", "more files in the folders for temporary files, for work or of the FMU")


@RULES.add(
    "B19",
    "Processes end",
    "good practice",
    "end the processes that an instance starts no later than in fmi2FreeInstance, and wait for them",
)
def left_processes(bench: Bench) -> Iterator[str]:
    _growth(bench, "files")  # after many lives
    left = _others()
    if left:
        yield f"after all instances are freed, {len(left)} processes that the FMU started still run"


def _others() -> list[processes.Process]:
    """The processes under the same guard besides this one and its keeper, or below this one if there is no guard."""
    mark = os.environ.get(MARK)
    if mark is None:
        return processes.below(os.getpid(), processes.everything())
    return [p for p in processes.bearing(f"{MARK}={mark}") if p.pid not in (os.getpid(), os.getppid())]
