"""Patterns in names: * and ? stand for characters between two dots, ** for any characters, dots included.

`car*.llc.filter.speed` fits car1.llc.filter.speed and car12.llc.filter.speed; `**.fl` fits every name that ends in .fl.
All other characters stand for themselves, brackets too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from functools import cache

_WILD = {"**": ".*", "*": r"[^.]*", "?": r"[^.]"}


def is_pattern(text: str) -> bool:
    """Whether `text` has a character that stands for others."""
    return "*" in text or "?" in text


def matches(name: str, pattern: str) -> bool:
    """Whether the whole `name` fits `pattern`."""
    return _compiled(pattern).fullmatch(name) is not None


def matches_any(name: str, patterns: Iterable[str]) -> bool:
    """Whether the whole `name` fits one of the patterns."""
    return any(matches(name, pattern) for pattern in patterns)


def fits_beginning(name: str, pattern: str) -> bool:
    """Whether `name` and something after a dot could fit `pattern`: `car1.llc` begins what `car*.llc.speed` fits.

    The pattern goes on after one of its dots, or anywhere in what a ** of it stands for.
    """
    dots = (found.start() for found in re.finditer(r"\.", pattern))
    inside = (found.end() for found in re.finditer(r"\*\*", pattern))
    return any(matches(name, pattern[:end]) for end in (*dots, *inside))


def captured(name: str, pattern: str) -> tuple[str, ...] | None:
    """The text that each wildcard of the pattern stands for in `name`; None where the name does not fit."""
    found = _compiled(pattern).fullmatch(name)
    return found.groups() if found else None


def substituted(pattern: str, texts: Sequence[str]) -> str:
    """The pattern with its wildcards replaced by the texts in turn, as far as there are any."""
    left = iter(texts)
    return "".join(next(left, part) if part in _WILD else part for part in _parts(pattern))


def _parts(pattern: str) -> list[str]:
    return re.split(r"(\*\*|\*|\?)", pattern)


@cache
def _compiled(pattern: str) -> re.Pattern[str]:
    return re.compile("".join(f"({_WILD[part]})" if part in _WILD else re.escape(part) for part in _parts(pattern)))
