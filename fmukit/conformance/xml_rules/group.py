"""The group X and how its rules are added."""

from __future__ import annotations

from collections.abc import Callable, Hashable, Iterable, Iterator

from fmukit.conformance.package import Package
from fmukit.conformance.rule import NotApplicable, Rules

Check = Callable[[Package], Iterator[str]]
XML: Rules[Package] = Rules("X")


def rule(title: str, section: str, remedy: str) -> Callable[[Check], Check]:
    """A rule that reads variables and attributes: it applies to descriptions that follow the schema."""

    def register(check: Check) -> Check:
        def guarded(package: Package) -> Iterator[str]:
            if not package.readable:
                raise NotApplicable("the description cannot be relied on, see the first rules of X")
            yield from check(package)

        XML.add(title, section, remedy)(guarded)
        return check

    return register


def repeated(names: Iterable[Hashable]) -> list[Hashable]:
    """What occurs more than once, in order of first repetition."""
    seen: set[Hashable] = set()
    twice: dict[Hashable, None] = {}
    for name in names:
        if name in seen:
            twice[name] = None
        seen.add(name)
    return list(twice)
