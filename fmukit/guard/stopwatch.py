"""The time a guarded process really had: a machine that is busy with other things takes it away unseen."""

from __future__ import annotations

from dataclasses import dataclass
from math import nan
from time import monotonic

from fmukit.guard.guarded import Guarded
from fmukit.guard.keeper import processes

_LATE = 0.5


@dataclass(frozen=True, slots=True)
class Time:
    """Since the start of a stopwatch [s]: `wall` by the clock, `cpu` used by all its processes, and `starved`, in which
    some of them were ready to run and got no processor (or the machine did not even let this process look).

    `cpu` is NaN where the system does not tell it.
    """

    wall: float = 0.0
    cpu: float = 0.0
    starved: float = 0.0

    @property
    def had(self) -> float:
        """What it had for itself, running or asleep."""
        return self.wall - self.starved

    def __sub__(self, other: Time) -> Time:
        return Time(self.wall - other.wall, self.cpu - other.cpu, self.starved - other.starved)


class Stopwatch:
    """Time of one guarded process; `look` several times a second, since a look that comes late counts as starving.

    Where the system has no /proc the time in which it starved is seen only as looks that come late.
    """

    def __init__(self, guarded: Guarded) -> None:
        self._guarded = guarded
        self._began = self._last = monotonic()
        self._cpu = self._starved = 0.0
        self._waited: dict[int, float] = {}
        self._told = processes.HAS_PROC or bool(processes.listed())

    def look(self) -> Time:
        """The time until now."""
        family = self._guarded.family()
        if family:
            self._cpu = max(self._cpu, sum(process.cpu + process.reaped for process in family))
        now = monotonic()
        past, self._last = now - self._last, now
        waited = {process.pid: processes.waited(process.pid) for process in family}
        queued = sum(max(0.0, time - self._waited.get(pid, 0.0)) for pid, time in waited.items())
        self._waited = waited
        self._starved += min(past, max(queued, past - _LATE))
        return Time(now - self._began, self._cpu if self._told else nan, self._starved)
