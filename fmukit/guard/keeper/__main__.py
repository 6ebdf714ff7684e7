"""Starts a command, adopts all it leaves behind, holds it to its limits, and ends it all when it is time.

Arguments: a JSON object with the limits, the folders that stay `writable` (null: all), the descriptor `owner` to read
from (its end is the end of the owner, or of its patience) and the descriptor `report` to write to; then the command.
Two lines of JSON go to the report: {"pid": number} of the command, and how it ended: {"code": -9 for signal 9,
"reason": "", "left": processes ended with it, "peak": memory in bytes}. Standard library only; this folder is run as it
is.
"""

from __future__ import annotations

import ctypes
import json
import os
import select
import signal
import sys
from contextlib import suppress
from itertools import pairwise
from time import monotonic
from typing import Any, NoReturn

import processes  # type: ignore[import-not-found]
from fence import fence  # type: ignore[import-not-found]
from limits import Limits, apply  # type: ignore[import-not-found]

_PDEATHSIG, _DUMPABLE, _SUBREAPER = 1, 4, 36  # numbers of prctl
_NOT_STARTED = 127
_WAKING = (signal.SIGCHLD, signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT, signal.SIGUSR1, signal.SIGUSR2)


class Keeper:
    """The command `child` and everything below this process."""

    def __init__(self, child: int, limits: Any) -> None:
        self.child, self.limits = child, limits
        self.code: int | None = None
        self.peak = 0

    def reap(self) -> None:
        """Take note of what has ended."""
        with suppress(ChildProcessError):
            while True:
                pid, status = os.waitpid(-1, os.WNOHANG)
                if pid == 0:
                    return
                if pid == self.child:
                    self.code = os.waitstatus_to_exitcode(status)

    def family(self) -> list[Any]:
        """What still runs below this process."""
        self.reap()
        return list(processes.below(os.getpid(), processes.everything()))

    def excess(self) -> str:
        """Which limit the family exceeds, if any."""
        family = self.family()
        memory = int(sum(process.memory for process in family))
        self.peak = max(self.peak, memory)
        if self.limits.processes is not None and len(family) > self.limits.processes:
            return "processes"
        if self.limits.memory is not None and memory > self.limits.memory:
            return "memory" if processes.holding(family) > self.limits.memory else ""
        return ""

    def watch(self, owner: int, woken: int) -> str:
        """Until the command or its owner ends or a limit is exceeded: which one of these."""
        due = monotonic()
        while True:
            self.reap()
            if self.code is not None:
                return ""
            if monotonic() >= due:
                began = monotonic()
                reason = self.excess()
                if reason:
                    return reason
                due = monotonic() + max(self.limits.interval, 10 * (monotonic() - began))
            ready, _, _ = select.select([owner, woken], [], [], max(0.0, due - monotonic()))
            if woken in ready:
                os.read(woken, 4096)
            if owner in ready and not os.read(owner, 4096):
                return "owner"

    def finish(self) -> int:
        """End the family; how many there were besides the command."""
        alone = self.code is not None
        count = int(processes.end_all(self.family))
        self.reap()
        return count if alone else max(0, count - 1)


def _prctl(option: int, value: int) -> None:
    if sys.platform == "linux":
        ctypes.CDLL(None).prctl(option, value, 0, 0, 0)


def _start(command: list[str], limits: Any, writable: list[str] | None) -> int:
    """The process number of the command, in a session of its own, which dies with this process."""
    keeper = os.getpid()
    child = os.fork()
    if child == 0:
        try:
            os.setsid()
            _prctl(_PDEATHSIG, signal.SIGKILL)
            if os.getppid() != keeper:
                os._exit(_NOT_STARTED)
            for number in (signal.SIGPIPE, signal.SIGXFSZ):  # which Python ignores
                signal.signal(number, signal.SIG_DFL)
            apply(limits, processes.threads())
            if writable is not None:
                fence(writable)
            os.execvpe(command[0], command, os.environ)
        except BaseException as error:
            os.write(2, f"{command[0]} cannot be started: {error}\n".encode())
        os._exit(_NOT_STARTED)
    return child


def _forget(*kept: int) -> None:
    """Close all descriptors but those, so that who reads from the command sees when it ends."""
    nothing = os.open(os.devnull, os.O_RDWR)
    for number in (0, 1, 2):
        os.dup2(nothing, number)
    edges = [2, *sorted(kept), os.sysconf("SC_OPEN_MAX")]
    for low, high in pairwise(edges):
        os.closerange(low + 1, high)


def _wakes() -> tuple[int, int]:
    """The ends of a pipe that can be read when a signal came; none of those that can be caught ends this process."""
    woken, wake = os.pipe()
    os.set_blocking(wake, False)
    signal.set_wakeup_fd(wake, warn_on_full_buffer=False)
    for number in _WAKING:
        signal.signal(number, lambda *_: None)
    return woken, wake


def _say(report: int, **event: object) -> None:
    with suppress(OSError):
        os.write(report, json.dumps(event).encode() + b"\n")


def _main(text: str, command: list[str]) -> NoReturn:
    orders = json.loads(text)
    owner, report = orders["owner"], orders["report"]
    for number in (owner, report):
        os.set_inheritable(number, False)
    _prctl(_SUBREAPER, 1)
    _prctl(_DUMPABLE, 0)
    limits = Limits(**orders["limits"])
    woken, wake = _wakes()
    child = _start(command, limits, orders["writable"])
    _forget(owner, report, woken, wake)
    _say(report, pid=child)
    keeper = Keeper(child, limits)
    reason = keeper.watch(owner, woken)
    left = keeper.finish()
    _say(report, code=keeper.code, reason=reason, left=left, peak=keeper.peak)
    os._exit(0)


_main(sys.argv[1], sys.argv[2:])
