"""What a user can do wrong, said in one sentence."""

from __future__ import annotations

import difflib
from collections.abc import Iterable

from fmukit.errors import UserError


class CosimError(UserError):
    """A mistake in what the user asked for, or a file that cannot be used; the text is one sentence for the user."""


class RunFailedError(Exception):
    """A run that began and did not end as it should; the text is one sentence for the user."""


class RunInterruptedError(RunFailedError):
    """A run that the user ended."""


def unknown(kind: str, name: str, known: Iterable[str], look: str = "") -> CosimError:
    """The error for a name that does not exist: the closest names, or all if few, else `look` says where they are."""
    candidates = sorted(known)
    close = difflib.get_close_matches(name, candidates, n=3, cutoff=0.5)
    if close:
        return CosimError(f"unknown {kind} {name!r}; did you mean {' or '.join(close)}?")
    if len(candidates) <= 12:
        return CosimError(f"unknown {kind} {name!r}; known are {', '.join(candidates) or 'none'}")
    return CosimError(f"unknown {kind} {name!r}" + (f"; {look}" if look else ""))
