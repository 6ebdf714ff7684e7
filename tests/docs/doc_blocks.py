"""What is done with a block of a page, by its language; every function gives what went wrong, or ""."""

from __future__ import annotations

import csv
import doctest
import io
import json
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import doc_commands as commands
from doc_pages import Block

from cosim.replay.form import MapForm
from cosim.system_file.decoding import read_form
from cosim.system_file.form import EventsForm
from cosim.system_file.parameters import read_parameters
from cosim.system_file.reading import read_system
from fmukit.interface import load_parameters
from fmukit.runtime.table import read as read_table
from fmus.controllers.reference.interface import INTERFACE
from fmus.planner.road_file import read_road

PARSERS: dict[str, Callable[[str], object]] = {
    "csv": lambda text: list(csv.reader(io.StringIO(text), strict=True)),
    "json": json.loads,
    "toml": tomllib.loads,
}
READERS: dict[str, Callable[[Path], object]] = {
    "road.csv": read_road,
    "trajectory.csv": lambda path: read_table(str(path), INTERFACE.table, path.parent),  # type: ignore[arg-type]
    "parameters.toml": load_parameters,
    "pyproject.toml": Path.read_text,
    "gains.toml": read_parameters,
    "coasting.toml": read_system,
    "map.toml": lambda path: read_form(path, MapForm),
    "gust.toml": lambda path: read_form(path, EventsForm),
}
"""By the name of the file that a block of data is, and under which the blocks after it find it."""
RUN = ("sh", "python", "pycon")


def is_source(block: Block) -> bool:
    """Whether a block of Python is a file, named after the language, which the blocks after it import or install."""
    return block.tag == "python" and block.note.endswith(".py")


def done(block: Block, folder: Path, wanted: Callable[[str], bool]) -> str:
    """Run or read a block in `folder`, the current one; of a script only the commands that are `wanted`."""
    if block.tag == "sh":
        return _script(block, folder, wanted)
    if block.tag == "pycon":
        return _example(block)
    if is_source(block):
        (folder / block.note).write_text(block.content, "utf-8")
    elif block.tag == "python":
        exec(compile("\n" * block.line + block.content, "a block of Python", "exec"), {"__name__": "__main__"})
    if block.tag in PARSERS:
        PARSERS[block.tag](block.content)
        (folder / block.note).write_text(block.content, "utf-8")
        READERS[block.note](folder / block.note)
    return ""


def _script(block: Block, folder: Path, wanted: Callable[[str], bool]) -> str:
    if not (folder / ".venv").exists():
        (folder / ".venv").symlink_to(sys.prefix)
    return " ".join(commands.executed(command, folder) for command in commands.lines(block.content) if wanted(command))


def _example(block: Block) -> str:
    said: list[str] = []
    test = doctest.DocTestParser().get_doctest(block.content, {}, "example", None, 0)
    if not test.examples:
        return "there is nothing after >>>"
    doctest.DocTestRunner(verbose=False).run(test, out=said.append)
    return "".join(said)
