"""What the rules of group X share."""

from __future__ import annotations

from collections.abc import Hashable, Iterable

from fmukit.conformance.package import Package


def reliable(package: Package) -> str:
    """Why rules about variables and attributes do not apply: they need a description that follows the schema."""
    return "" if package.readable else "the description cannot be relied on, see the first rules of X"


def repeated(names: Iterable[Hashable]) -> list[Hashable]:
    """What occurs more than once, in order of first repetition."""
    seen: set[Hashable] = set()
    twice: dict[Hashable, None] = {}
    for name in names:
        if name in seen:
            twice[name] = None
        seen.add(name)
    return list(twice)
