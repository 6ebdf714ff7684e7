"""How a run ended."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from cosim.engine.slave import SlaveError

Status = Literal["ok", "missed", "failed", "interrupted"]
"""`missed`: the run went to its end, but not as its scenario wants."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a run ended: at simulated `time` [ns], after `wall` [ns]; calls and time [ns] per instance.

    It began, or was resumed, after the tick at `begun` [ns].
    """

    status: Status
    reason: str
    time: int
    wall: int
    calls: Mapping[str, int]
    times: Mapping[str, int]
    begun: int = 0


def judged(failure: SlaveError, when: str) -> tuple[str, str]:
    """Status and reason of a run that a slave ended."""
    if failure.ended:
        return "ok", f"{failure.instance} ended the simulation {when}"
    return "failed", failure.sentence(when)
