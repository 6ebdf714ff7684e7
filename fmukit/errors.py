"""What can go wrong and is the user's to put right."""

from __future__ import annotations


class UserError(Exception):
    """Something the user can put right; the message is one sentence saying what to do."""


class BuildError(UserError):
    """The FMU cannot be built."""
