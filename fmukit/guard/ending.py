"""How a process ended, in words."""

from __future__ import annotations

import signal
from dataclasses import dataclass

from fmukit.guard.keeper.limits import MIB, Limits


@dataclass(frozen=True, slots=True)
class Ending:
    """`code` is the exit status, or minus the signal, None if nobody saw it.

    `reason` says who ended it: "" itself, "owner" the one who started it, "memory" or "processes" a limit, "keeper"
    that its keeper was ended first. `left` counts processes it left behind, `peak` [bytes] is the most memory it held.
    """

    code: int | None
    reason: str = ""
    left: int = 0
    peak: int = 0

    def words(self, limits: Limits) -> str:
        """A sentence without its subject: 'was killed by signal 11 (Segmentation fault)'."""
        if self.reason == "memory":
            return f"was ended because it took more than {(limits.memory or 0) // MIB} MiB of memory"
        if self.reason == "processes":
            return f"was ended because it started more than {limits.processes} processes"
        if self.reason == "keeper":
            return "ended the process that watches it"
        return death(self.code)


def death(code: int | None) -> str:
    """How a process ended, from its exit status or minus its signal: 'ended with status 1'."""
    if code is None:
        return "ended unseen"
    if code >= 0:
        return f"ended with status {code}"
    try:
        return f"was killed by signal {-code} ({signal.strsignal(-code)})"
    except ValueError:
        return f"was killed by signal {-code}"
