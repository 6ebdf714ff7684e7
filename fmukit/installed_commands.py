"""Subcommands that other packages bring for a program: entry points of its group, each of them "module:function"."""

from __future__ import annotations

from importlib.metadata import entry_points

from fmukit.command_line import Subcommand
from fmukit.docstrings import first_line


def installed(group: str) -> list[Subcommand]:
    """The subcommands of the group; the help of each is the first line of its function, which is not imported."""
    found = sorted(entry_points(group=group), key=lambda point: point.name)
    return [Subcommand(point.name, first_line(point.value), point.value) for point in found]
