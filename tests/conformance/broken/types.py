"""Broken types: X19 to X21."""

from __future__ import annotations

from typing import Any

from broken.making import add_types, description, variable


@description("X19", "'Angle' is defined more than once")
def _two_types(root: Any) -> None:
    add_types(root, *['<SimpleType name="Angle"><Real/></SimpleType>'] * 2)


@description("X20", "declaredType 'Angle', which is not defined")
def _undefined(root: Any) -> None:
    variable(root, "parameter")[0].set("declaredType", "Angle")


@description("X20", "its declaredType 'Count' is Integer")
def _wrong_type(root: Any) -> None:
    add_types(root, '<SimpleType name="Count"><Integer/></SimpleType>')
    variable(root, "parameter")[0].set("declaredType", "Count")


MODES = '<SimpleType name="Mode"><Enumeration><Item name="a" value="1"/><Item name="b" value="{}"/></Enumeration>'


@description("X21", "enumeration Mode has two items of the value '1'")
def _items(root: Any) -> None:
    add_types(root, MODES.format(1) + "</SimpleType>")
