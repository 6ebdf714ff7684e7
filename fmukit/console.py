"""Where the command lines print tables."""

from __future__ import annotations

from rich.console import Console


def console_of(*, stderr: bool = False) -> Console:
    """A console that does not squeeze tables when its output goes to a file."""
    console = Console(highlight=False, stderr=stderr)
    return console if console.is_terminal else Console(highlight=False, stderr=stderr, width=160)
