"""What a rule is: an id, what must hold, where the standard says so, and the function that looks."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import islice
from typing import Any, Generic, Literal, TypeVar

S = TypeVar("S")
Status = Literal["pass", "fail", "skip", "undecided"]
Severity = Literal["violation", "advice"]
_COUNTED, _LONGEST = 5_000, 1_000
ADVICE = "good practice"
"""The section of rules that the standard does not ask for."""
Check = Callable[[S], Iterator[str]]
GROUPS = {"A": "archive", "X": "model description", "L": "life cycle", "B": "behaviour", "I": "isolation"}


class NotApplicable(Exception):  # noqa: N818  (a reason, not an error)
    """Raised by a check whose rule does not concern this FMU; the message says why."""


@dataclass(frozen=True, slots=True)
class Rule(Generic[S]):
    """`check` takes the subject of its group and yields one sentence, with the value seen, per violation.

    The `id` is the letter of the group and a number, which the rule keeps for good. `section` names the section of the
    FMI 2.0 standard, or ADVICE; `remedy` tells a newcomer what to do. `needs` gives the reason why the rule does not
    apply to a subject, or "". What breaks a `vital` rule is not run any further. Tools read the section of a `disputed`
    rule in different ways.
    """

    id: str
    title: str
    section: str
    remedy: str
    check: Check[S]
    needs: Callable[[S], str]
    vital: bool = False
    disputed: bool = False

    @property
    def severity(self) -> Severity:
        """If the rule does not hold, the FMU violates the standard or cannot run; or it could be better."""
        return "advice" if self.disputed or (self.section == ADVICE and not self.vital) else "violation"

    @property
    def group(self) -> str:
        """The name of the group."""
        return GROUPS[self.id[0]]

    def violations(self, subject: S) -> Iterator[str]:
        """One sentence per violation; raises NotApplicable."""
        reason = self.needs(subject)
        if reason:
            raise NotApplicable(reason)
        yield from self.check(subject)


@dataclass(frozen=True, slots=True)
class Finding:
    """What became of one rule on one FMU; `seen` has the sentences of a failure, or why it was skipped or undecided."""

    rule: Rule[Any]
    status: Status
    seen: tuple[str, ...] = ()

    def is_broken(self, severity: Severity) -> bool:
        """Whether the rule does not hold and is of that severity."""
        return self.status == "fail" and self.rule.severity == severity

    def fails(self, *, strict: bool) -> bool:
        """Whether the rule does not hold and is no mere advice; `strict`: or is."""
        return self.status == "fail" and (strict or self.rule.severity == "violation")


def nothing(_subject: object) -> str:
    """The `needs` of rules that apply to every subject."""
    return ""


class Rules(Generic[S]):
    """A table of rules with the same `needs`, filled by the decorator `add`."""

    def __init__(self, needs: Callable[[S], str] = nothing) -> None:
        self._needs = needs
        self._rules: list[Rule[S]] = []

    def __iter__(self) -> Iterator[Rule[S]]:
        return iter(self._rules)

    def add(
        self, id_: str, title: str, section: str, remedy: str, *, vital: bool = False, disputed: bool = False
    ) -> Callable[[Check[S]], Check[S]]:
        """Put the decorated check into the table as the rule `id_`."""

        def register(check: Check[S]) -> Check[S]:
            self._rules.append(Rule(id_, title, section, remedy, check, self._needs, vital, disputed))
            return check

        return register


def in_order(*tables: Rules[S]) -> tuple[Rule[S], ...]:
    """The rules of all tables by group and number; raises ValueError when two of them have the same id."""
    rules = [rule for table in tables for rule in table]
    ids = [rule.id for rule in rules]
    twice = sorted({id_ for id_ in ids if ids.count(id_) > 1})
    if twice:
        raise ValueError(f"there is more than one rule {', '.join(twice)}; give each an id of its own")
    return tuple(sorted(rules, key=lambda rule: (list(GROUPS).index(rule.id[0]), int(rule.id[1:]))))


def look(rule: Rule[S], subject: S, most: int = 5) -> Finding:
    """Apply one rule; of many violations the first `most` are kept and the rest counted, up to some thousands.

    A check that itself breaks down counts as a failure of its rule: an FMU must not be able to stop the check.
    """
    try:
        seen = list(islice(rule.violations(subject), _COUNTED))
    except NotApplicable as reason:
        return Finding(rule, "skip", (str(reason),))
    except Exception as error:
        seen = [f"{type(error).__name__}: {error}"]
    if len(seen) > most:
        many = "thousands" if len(seen) == _COUNTED else len(seen) - most
        seen = [*seen[:most], f"and {many} more"]
    return Finding(rule, "fail" if seen else "pass", tuple(map(_short, seen)))


def _short(sentence: str) -> str:
    """Names come from strangers and may be of any length."""
    half = _LONGEST // 2
    return sentence if len(sentence) <= _LONGEST else f"{sentence[:half]} ... {sentence[-half:]}"
