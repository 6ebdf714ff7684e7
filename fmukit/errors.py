"""What the user can put right."""

from __future__ import annotations

import re

_NUMBERED = re.compile(r".*\[errno \d+\] ", re.IGNORECASE)


class UserError(Exception):
    """A mistake of the user; the message is one sentence, which the command lines print before exit status 2."""


class BuildError(UserError):
    """The FMU cannot be built; the message is one sentence saying what to do."""


def because(error: OSError) -> str:
    """What the operating system said, without its error number and what libraries put around it."""
    return _NUMBERED.sub("", error.strerror or str(error)) or type(error).__name__
