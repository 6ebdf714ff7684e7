"""The floors of fmukit: each room imports from the floors below its own, and what travels imports next to nothing."""

from __future__ import annotations

import ast
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

FMUKIT = Path(__file__).parents[2] / "fmukit"
FLOORS = (
    {"errors", "files", "units", "packing", "unpacking", "docstrings", "command_line", "interface", "runtime", "guard"},
    {"store", "component"},
    {"compiling"},
    {"played"},
    {"direct"},
    {"packaging"},
    {"hosting", "conformance"},
)


def _imports(path: Path) -> Iterator[str]:
    """The dotted names of modules a file imports, wherever it does; relative ones begin with a dot."""
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield "." * node.level + (node.module or "")
            yield from (f"{node.module}.{alias.name}" for alias in node.names if not node.level)


def _files(room: str) -> list[Path]:
    return sorted((FMUKIT / room).rglob("*.py")) or [FMUKIT / f"{room}.py"]


@pytest.mark.parametrize("floor", range(len(FLOORS)))
def test_no_room_imports_from_a_floor_above(floor: int) -> None:
    above = set().union(*FLOORS[floor + 1 :])
    for path in (path for room in FLOORS[floor] for path in _files(room)):
        rooms = {name.split(".")[1] for name in _imports(path) if name.startswith("fmukit.")}
        assert not rooms & above, path


def test_what_travels_in_every_fmu_imports_only_what_is_there() -> None:
    allowed = sys.stdlib_module_names | {"pythonfmu"}
    for path in _files("runtime"):
        names = [name for name in _imports(path) if not (name.startswith(".") and not name.startswith(".."))]
        assert {name.split(".")[0] for name in names} <= allowed, path


def test_what_runs_without_packages_imports_the_standard_library_only() -> None:
    for path in _files("conformance/bare"):
        assert {name.split(".")[0] for name in _imports(path)} <= sys.stdlib_module_names | {"host", "pulse"}, path
