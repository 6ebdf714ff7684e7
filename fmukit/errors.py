"""What the user can put right."""

from __future__ import annotations


class UserError(Exception):
    """A mistake of the user; the message is one sentence, which the command lines print before exit status 2."""


class BuildError(UserError):
    """The FMU cannot be built; the message is one sentence saying what to do."""
