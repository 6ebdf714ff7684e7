"""UnitDefinitions and the units variables name."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmukit.conformance.package import Package
from fmukit.conformance.rule import Rules
from fmukit.conformance.xml_rules.group import reliable, repeated
from fmukit.units import BASES, SiUnit, parse

RULES: Rules[Package] = Rules(reliable)
_LARGEST_EXPONENT = 12
_RELATIVE = 1e-5  # authors round pi/180


@RULES.add(
    "X13", "Units have names of their own", "2.2.2", "Define every unit once; each Unit needs another, non-empty name."
)
def _unique(package: Package) -> Iterator[str]:
    names = [unit.get("name") for unit in _units(package)]
    yield from (f"the unit {name!r} is defined more than once" for name in repeated(names))
    if any(not name.strip() for name in names):
        yield "a unit has an empty name"
    for unit in _units(package):
        shown = [display.get("name") for display in unit.iterfind("DisplayUnit")]
        yield from (f"unit {unit.get('name')!r} has the display unit {name!r} twice" for name in repeated(shown))


@RULES.add(
    "X14",
    "Base units are sane",
    "2.2.2",
    "factor and offset must be finite and factor not 0; exponents of kg, m, s, A, K, mol, cd, rad are small numbers.",
)
def _base(package: Package) -> Iterator[str]:
    for unit in _units(package):
        for element in unit:
            yield from (f"unit {unit.get('name')!r}: {text}" for text in _scale(element))
            for base in BASES:
                if abs(int(element.get(base, "0"))) > _LARGEST_EXPONENT:
                    yield f"unit {unit.get('name')!r} has the exponent {element.get(base)} of {base}"


@RULES.add(
    "X15",
    "Base units agree with the names of the units",
    "good practice",
    "Correct exponents, factor or offset in BaseUnit, or the name of the unit; importers convert by the base unit.",
)
def _meaning(package: Package) -> Iterator[str]:
    for unit in _units(package):
        base, known = unit.find("BaseUnit"), _known(unit.get("name"))
        if base is not None and known is not None:
            yield from (f"unit {unit.get('name')!r} has {text}" for text in _differences(base, known))


@RULES.add(
    "X16",
    "Display units measure the same quantity as their unit",
    "2.2.2",
    "DisplayUnit converts by display value = factor * value + offset: correct these, or move the display unit.",
)
def _display(package: Package) -> Iterator[str]:
    for unit in _units(package):
        known = _known(unit.get("name"))
        for element in unit.iterfind("DisplayUnit"):
            shown = _known(element.get("name"))
            if known is not None and shown is not None:
                where = f"display unit {element.get('name')!r} of unit {unit.get('name')!r}"
                yield from (f"{where}: {text}" for text in _misfit(element, known, shown))


@RULES.add("X17", "Units used are defined", "2.2.2", "Add a Unit of this name to UnitDefinitions, or correct the name.")
def _defined(package: Package) -> Iterator[str]:
    names = {unit.get("name") for unit in _units(package)}
    for variable in package.variables:
        if variable.unit is not None and variable.unit not in names and "unit" in variable.given:
            yield f"variable {variable.name} has the unit {variable.unit!r}, which is not defined"
    for kind in package.root.iterfind("TypeDefinitions/SimpleType"):
        if kind[0].get("unit", next(iter(names), None)) not in names and kind[0].get("unit") is not None:
            yield f"type {kind.get('name')} has the unit {kind[0].get('unit')!r}, which is not defined"


@RULES.add(
    "X18",
    "Display units used are defined for the unit",
    "2.2.7",
    "Add a DisplayUnit of this name to the variable's Unit; a displayUnit needs a unit.",
)
def _display_defined(package: Package) -> Iterator[str]:
    shown = {unit.get("name"): {d.get("name") for d in unit.iterfind("DisplayUnit")} for unit in _units(package)}
    for variable in package.variables:
        if variable.display_unit is None:
            continue
        if variable.unit is None:
            yield f"variable {variable.name} has the displayUnit {variable.display_unit!r} but no unit"
        elif variable.unit in shown and variable.display_unit not in shown[variable.unit] | {variable.unit}:
            yield f"variable {variable.name}: unit {variable.unit!r} has no display unit {variable.display_unit!r}"


def _units(package: Package) -> list[Any]:
    return list(package.root.iterfind("UnitDefinitions/Unit"))


def _known(name: str) -> SiUnit | None:
    """What a name means to everybody; None if it is a tool's own name."""
    try:
        return parse(name)
    except (ValueError, ZeroDivisionError, OverflowError, RecursionError):
        return None


def _scale(element: Any) -> Iterator[str]:
    factor, offset = float(element.get("factor", "1")), float(element.get("offset", "0"))
    if not math.isfinite(factor) or factor == 0:
        yield f"factor of {element.tag} is {factor}"
    if not math.isfinite(offset):
        yield f"offset of {element.tag} is {offset}"


def _differences(base: Any, known: SiUnit) -> Iterator[str]:
    for name, exponent in zip(BASES, known.exponents, strict=True):
        seen = int(base.get(name, "0"))
        if seen != exponent and name != "rad":  # many tools take the radian for a pure number
            yield f"the exponent {seen} of {name} where its name means {exponent}"
    for name, meant in (("factor", known.factor), ("offset", known.offset)):
        seen_value = float(base.get(name, "0" if name == "offset" else "1"))
        if seen_value != 0 or name == "offset":
            yield from _differs(name, seen_value, meant)


def _misfit(element: Any, unit: SiUnit, shown: SiUnit) -> Iterator[str]:
    """value_SI = f_u v + o_u = f_d w + o_d, hence w = (f_u/f_d) v + (o_u - o_d)/f_d."""
    if unit.exponents[:-1] != shown.exponents[:-1]:  # the last is rad
        yield "the two do not measure the same quantity"
        return
    yield from _differs("factor", float(element.get("factor", "1")), unit.factor / shown.factor)
    yield from _differs("offset", float(element.get("offset", "0")), (unit.offset - shown.offset) / shown.factor)


def _differs(name: str, seen: float, meant: float) -> Iterator[str]:
    if math.isfinite(seen) and not math.isclose(seen, meant, rel_tol=_RELATIVE, abs_tol=1e-12):
        yield f"the {name} {seen:g} where its name means {meant:.9g}"
