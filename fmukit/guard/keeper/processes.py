"""The processes of this system and who started whom: from /proc where there is one, else from the command ps."""

from __future__ import annotations

import os
import signal
import subprocess
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from time import monotonic, sleep

_PROC = Path("/proc")
HAS_PROC = (_PROC / "self" / "stat").is_file()
_TICK = os.sysconf("SC_CLK_TCK") if hasattr(os, "sysconf") else 100
_PAGE = os.sysconf("SC_PAGE_SIZE") if hasattr(os, "sysconf") else 4096
_DEAD = "ZX"
_MOMENT = 0.002


@dataclass(frozen=True, slots=True)
class Process:
    """One process: `cpu` [s] is its own time, `reaped` [s] that of children it has waited for, `memory` [bytes] what it
    holds of the machine's memory, `state` the letter of ps."""

    pid: int
    parent: int
    state: str
    cpu: float
    reaped: float
    memory: int
    threads: int = 1

    @property
    def alive(self) -> bool:
        """Whether it still runs: what has ended and waits for its parent to ask does not."""
        return self.state[:1] not in _DEAD


def read(pid: int) -> Process | None:
    """One process from /proc, None if it is gone."""
    try:
        text = (_PROC / str(pid) / "stat").read_text("utf-8", "replace")
    except OSError:
        return None
    fields = text[text.rindex(")") + 2 :].split()
    cpu, reaped = ((int(fields[k]) + int(fields[k + 1])) / _TICK for k in (11, 13))
    return Process(pid, int(fields[1]), fields[0], cpu, reaped, int(fields[21]) * _PAGE, int(fields[17]))


def everything() -> dict[int, Process]:
    """All processes by number."""
    if not HAS_PROC:
        return listed()
    found = (read(int(name)) for name in os.listdir(_PROC) if name.isdigit())
    return {process.pid: process for process in found if process is not None}


def listed() -> dict[int, Process]:
    """All processes, as the command ps of any POSIX system tells them; none where there is no ps."""
    command = ["ps", "-A", "-o", "pid=,ppid=,stat=,time=,rss="]
    try:
        text = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    except OSError:
        return {}
    rows = [line.split() for line in text.splitlines()]
    return {
        int(pid): Process(int(pid), int(parent), state, _seconds(time), 0.0, int(memory) * 1024)
        for pid, parent, state, time, memory in (row for row in rows if len(row) == 5)
    }


def _seconds(text: str) -> float:
    """[[days-]hours:]minutes:seconds."""
    days, _, rest = text.rpartition("-")
    total = 0.0
    for part in rest.split(":"):
        total = 60.0 * total + float(part)
    return total + 86400.0 * int(days or 0)


def threads() -> int:
    """How many threads there are on the system; 0 if nobody can tell."""
    return sum(process.threads for process in everything().values()) if HAS_PROC else 0


def below(root: int, among: dict[int, Process]) -> list[Process]:
    """The descendants of `root` that still run, `root` itself not counted."""
    children: dict[int, list[Process]] = {}
    for process in among.values():
        children.setdefault(process.parent, []).append(process)
    found, left = [], [root]
    while left:
        started = children.get(left.pop(), [])
        found += started
        left += [process.pid for process in started]
    return [process for process in found if process.alive]


def holding(processes: Iterable[Process]) -> int:
    """The memory they hold together [bytes], what they share counted once where the system tells it."""
    return sum(_proportional(process) for process in processes)


def _proportional(process: Process) -> int:
    try:
        text = (_PROC / str(process.pid) / "smaps_rollup").read_text()
    except OSError:
        return process.memory
    shares = [int(line.split()[1]) * 1024 for line in text.splitlines() if line.startswith("Pss:")]
    return sum(shares) if shares else process.memory


def bearing(mark: str) -> list[Process]:
    """The processes with `mark`, a NAME=VALUE, in the environment they were started with; none without /proc."""
    if not HAS_PROC:
        return []
    wanted = mark.encode()
    return [p for p in everything().values() if p.alive and wanted in _environment(p.pid).split(b"\0")]


def _environment(pid: int) -> bytes:
    try:
        return (_PROC / str(pid) / "environ").read_bytes()
    except OSError:
        return b""


def waited(pid: int) -> float:
    """How long [s] the threads of a process were ready and had to wait for a processor; 0 where nobody counts that."""
    total = 0
    with suppress(OSError):
        for thread in os.listdir(_PROC / str(pid) / "task"):
            with suppress(OSError, IndexError, ValueError):
                total += int((_PROC / str(pid) / "task" / thread / "schedstat").read_text().split()[1])
    return total * 1e-9


def end_all(find: Callable[[], list[Process]], patience: float = 5.0) -> int:
    """End what `find` finds until it finds nothing, or for `patience` [s]; how many processes there were.

    They are stopped before they are ended, so that none can start another one meanwhile.
    """
    until = monotonic() + patience
    seen: set[int] = set()
    while True:
        found = find()
        fresh = [process for process in found if process.pid not in seen]
        seen.update(process.pid for process in fresh)
        if not found or monotonic() > until:
            return len(seen)
        _send(signal.SIGSTOP if fresh else signal.SIGKILL, fresh or found)
        if not fresh:
            sleep(_MOMENT)


def _send(number: int, to: Iterable[Process]) -> None:
    for process in to:
        with suppress(ProcessLookupError, PermissionError):
            os.kill(process.pid, number)
