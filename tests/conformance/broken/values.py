"""Broken values: X30 to X36."""

from __future__ import annotations

from typing import Any

from broken.making import add_types, add_variable, description, variable
from broken.types import MODES
from broken.variables import DISCRETE


@description("X30", "(initial exact) has no start value")
def _no_start(root: Any) -> None:
    del variable(root, "parameter")[0].attrib["start"]


@description("X31", "is calculated and has the start value 1.0")
def _start(root: Any) -> None:
    variable(root, "output")[0].set("start", "1.0")


@description("X32", "has the start value nan")
def _nan(root: Any) -> None:
    variable(root, "parameter")[0].set("start", "NaN")


@description("X33", "variable count starts at 0, outside [1, 2]")
def _outside(root: Any) -> None:
    add_variable(root, "count", DISCRETE | {"initial": "exact"}, "Integer", start="0", min="1", max="2")


@description("X34", "starts at 0, which is none of [1, 2]")
def _no_item(root: Any) -> None:
    add_types(root, MODES.format(2) + "</SimpleType>")
    kind = {"causality": "parameter", "variability": "fixed"}
    add_variable(root, "mode", kind, "Enumeration", declaredType="Mode", start="0")


@description("X35", "has min 2.0 and max 1.0")
def _order(root: Any) -> None:
    variable(root, "output")[0].attrib.update({"min": "2", "max": "1"})


@description("X35", "type Speed has min 2 and max 1")
def _order_of_a_type(root: Any) -> None:
    add_types(root, '<SimpleType name="Speed"><Real min="2" max="1"/></SimpleType>')


@description("X36", "type Speed has the nominal value 0")
def _nominal_of_a_type(root: Any) -> None:
    add_types(root, '<SimpleType name="Speed"><Real nominal="0"/></SimpleType>')


@description("X36", "has the nominal value -5.0")
def _nominal(root: Any) -> None:
    variable(root, "output")[0].set("nominal", "-5")
