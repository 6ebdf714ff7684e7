"""Docstrings of functions that are not to be imported, read from their sources."""

from __future__ import annotations

import ast
import sys
from itertools import accumulate
from pathlib import Path


def first_line(function: str) -> str:
    """The first line of the docstring of "module:function"; "" when there is none to be found. Nothing is imported."""
    module, _, name = function.partition(":")
    source = _source(module)
    if source is None:
        return ""
    for node in _parsed(source):
        if isinstance(node, ast.FunctionDef) and node.name == name:
            return (ast.get_docstring(node) or "").partition("\n")[0]
    return ""


def _parsed(source: Path) -> list[ast.stmt]:
    """The statements of a Python file; none when it is not one."""
    try:
        return ast.parse(source.read_text("utf-8")).body
    except (OSError, ValueError, SyntaxError):
        return []


def _source(module: str) -> Path | None:
    """The Python file of a module. `importlib.util.find_spec` would import the packages it lies in."""
    origin, places = None, None
    for name in accumulate(module.split("."), "{}.{}".format):
        found = (finder.find_spec(name, places) for finder in sys.meta_path if hasattr(finder, "find_spec"))
        spec = next(filter(None, found), None)
        if spec is None:
            return None
        origin, places = spec.origin, spec.submodule_search_locations
    return Path(origin) if origin and origin.endswith(".py") else None
