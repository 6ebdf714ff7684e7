"""What can go wrong and is the user's to put right."""

from __future__ import annotations

import re

_NUMBERED = re.compile(r".*\[errno \d+\] ", re.IGNORECASE)


class UserError(Exception):
    """Something the user can put right; the message is one sentence saying what to do."""


class BuildError(UserError):
    """The FMU cannot be built."""


def because(error: OSError) -> str:
    """What the operating system said, without its error number and what libraries put around it."""
    return _NUMBERED.sub("", error.strerror or str(error)) or type(error).__name__
