"""Patterns in names: * and ? stand for characters between two dots, ** for any characters, dots included.

`car*.llc.filter.speed` fits car1.llc.filter.speed and car12.llc.filter.speed; `**.fl` fits every name that ends in .fl.
All other characters stand for themselves, brackets too.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
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


@cache
def _compiled(pattern: str) -> re.Pattern[str]:
    parts = re.split(r"(\*\*|\*|\?)", pattern)
    return re.compile("".join(_WILD.get(part, re.escape(part)) for part in parts))
