"""The XML schema of FMI 2.0, as FMPy ships it."""

from __future__ import annotations

from functools import cache
from importlib.resources import as_file, files
from typing import Any

from lxml import etree


def violations(root: Any) -> tuple[str, ...]:
    """Sentences with the line and what the schema wanted there."""
    schema = _schema()
    schema.validate(root)
    return tuple(f"line {error.line}: {error.message}" for error in schema.error_log)


@cache
def _schema() -> Any:
    with as_file(files("fmpy") / "schema" / "fmi2") as folder:
        return etree.XMLSchema(etree.parse(folder / "fmi2ModelDescription.xsd"))
