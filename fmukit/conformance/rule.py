"""What a rule is: a number, what must hold, where the standard says so, and the function that looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Generic, Literal, TypeVar

S = TypeVar("S")
Status = Literal["pass", "fail", "skip"]
GROUPS = {"A": "archive", "X": "model description", "L": "life cycle", "B": "behaviour", "I": "isolation"}


class NotApplicable(Exception):  # noqa: N818  (a reason, not an error)
    """Raised by a check whose rule does not concern this FMU; the message says why."""


@dataclass(frozen=True, slots=True)
class Rule(Generic[S]):
    """`check` takes the subject of its group and yields one sentence, with the value seen, per violation.

    `section` names the section of the FMI 2.0 standard, or "good practice"; `remedy` tells a newcomer what to do.
    """

    number: str
    title: str
    section: str
    remedy: str
    check: Callable[[S], Iterator[str]]

    @property
    def group(self) -> str:
        return GROUPS[self.number[0]]


@dataclass(frozen=True, slots=True)
class Finding:
    """What became of one rule on one FMU; `seen` has the sentences of a failure, or the reason of a skip."""

    rule: Rule[Any]
    status: Status
    seen: tuple[str, ...] = ()


class Rules(Generic[S]):
    """An ordered group of rules, filled by the decorator `add`; numbers follow the order: A1, A2, ..."""

    def __init__(self, letter: str) -> None:
        self.letter = letter
        self.rules: list[Rule[S]] = []

    def add(
        self, title: str, section: str, remedy: str
    ) -> Callable[[Callable[[S], Iterator[str]]], Callable[[S], Iterator[str]]]:
        """Register the decorated check as the next rule of the group."""

        def register(check: Callable[[S], Iterator[str]]) -> Callable[[S], Iterator[str]]:
            number = f"{self.letter}{len(self.rules) + 1}"
            self.rules.append(Rule(number, title, section, remedy, check))
            return check

        return register


def look(rule: Rule[S], subject: S, most: int = 5) -> Finding:
    """Apply one rule; of many violations the first `most` are kept and the rest counted.

    A check that itself breaks down counts as a failure of its rule: an FMU must not be able to stop the check.
    """
    try:
        seen = list(rule.check(subject))
    except NotApplicable as reason:
        return Finding(rule, "skip", (str(reason),))
    except Exception as error:
        seen = [f"{type(error).__name__}: {error}"]
    if len(seen) > most:
        seen = [*seen[:most], f"and {len(seen) - most} more"]
    return Finding(rule, "fail" if seen else "pass", tuple(seen))
