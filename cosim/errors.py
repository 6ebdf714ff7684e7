"""What a user can do wrong, said in one sentence."""

from __future__ import annotations

import difflib
from collections.abc import Iterable


class CosimError(Exception):
    """A mistake in what the user asked for, or a file that cannot be used; the text is one sentence for the user."""


def unknown(kind: str, name: str, known: Iterable[str]) -> CosimError:
    """The error for a name that does not exist, with the names closest to it."""
    candidates = sorted(known)
    close = difflib.get_close_matches(name, candidates, n=3, cutoff=0.5)
    if close:
        return CosimError(f"unknown {kind} {name!r}; did you mean {' or '.join(close)}?")
    if len(candidates) <= 12:
        return CosimError(f"unknown {kind} {name!r}; known are {', '.join(candidates) or 'none'}")
    return CosimError(f"unknown {kind} {name!r}")
