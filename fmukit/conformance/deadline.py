"""When to stop waiting for an FMU, and what to say then: a hang is told from a busy machine."""

from __future__ import annotations

from dataclasses import dataclass
from math import isnan

from fmukit.guard.stopwatch import Time

_IDLE = 0.2


@dataclass(frozen=True, slots=True)
class Deadline:
    """Times [s]: `call` that a call may take, `rule` that a rule may, both of the time the FMU had for itself; `busy`
    how many times as long the clock may run, and `check` what the whole check may take by the clock."""

    call: float = 30.0
    rule: float = 300.0
    busy: float = 4.0
    check: float = 1800.0

    def over(self, call: str, of_call: Time, of_rule: Time) -> tuple[str, str] | None:
        """The status ("fail" or "undecided") and a sentence when it is time to stop, None if it is not.

        `call` names the call that has not returned, "" if there is none; `of_call` and `of_rule` are the times since it
        and since the rule began.
        """
        if of_call.had >= self.call:
            return "fail", f"{_named(call)} within {self.call:g} s{_how(of_call)}"
        if of_call.wall >= self.busy * self.call or of_rule.wall >= self.busy * self.rule:
            past = of_call if of_call.wall >= self.busy * self.call else of_rule
            return "undecided", (
                f"the machine was too busy: in {past.wall:.0f} s the FMU had the processor for {past.cpu:.1f} s and "
                f"had to wait for it for {past.starved:.0f} s; check again when less is running"
            )
        if of_rule.had >= self.rule:
            return "undecided", f"after {self.rule:g} s this was not decided yet: the calls of this FMU take long"
        return None


def _named(call: str) -> str:
    if not call:
        return "between two calls a process that runs the FMU did not go on"
    return f"{call} did not end" if call.startswith("the ") else f"{call} did not return"


def _how(past: Time) -> str:
    if isnan(past.cpu):
        return ""
    if past.cpu < _IDLE * past.had:
        return f", in which it used the processor for {past.cpu:.1f} s: it sleeps or waits"
    return f", in which it used the processor for {past.cpu:.1f} s"
