"""What can go wrong while building and is the user's to put right."""

from __future__ import annotations


class BuildError(Exception):
    """The FMU cannot be built; the message is one sentence saying what to do."""
