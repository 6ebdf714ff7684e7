"""Broken units: X13 to X18."""

from __future__ import annotations

from typing import Any

from lxml import etree

from broken.making import description, unit, variable


@description("X13", "'m' is defined more than once")
def _two_units(root: Any) -> None:
    root.find("UnitDefinitions").append(etree.fromstring('<Unit name="m"><BaseUnit m="1"/></Unit>'))


@description("X14", "'m': factor of BaseUnit is 0.0")
def _zero_factor(root: Any) -> None:
    unit(root, "m")[0].set("factor", "0")


@description("X15", "'m/s2' has the exponent -1 of s where its name means -2")
def _exponent(root: Any) -> None:
    unit(root, "m/s2")[0].set("s", "-1")


@description("X15", "has the factor 3.14")
def _factor(root: Any) -> None:
    unit(root, "s")[0].set("factor", "3.14")


@description("X16", "display unit 'm' of unit 'rad/s': the two do not measure the same quantity")
def _other_quantity(root: Any) -> None:
    etree.SubElement(unit(root, "rad/s"), "DisplayUnit", name="m")


@description("X16", "the factor 0.0174533 where its name means 57.29")
def _inverse(root: Any) -> None:
    etree.SubElement(unit(root, "rad/s"), "DisplayUnit", name="deg/s", factor="0.0174532925")


@description("X17", "has the unit 'furlong'")
def _furlong(root: Any) -> None:
    variable(root, "parameter")[0].set("unit", "furlong")


@description("X18", "has no display unit 'km'")
def _display(root: Any) -> None:
    variable(root, "parameter")[0].set("displayUnit", "km")
