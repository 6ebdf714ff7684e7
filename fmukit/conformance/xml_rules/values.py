"""Start values, limits and nominal values."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from fmukit.conformance.package import Package
from fmukit.conformance.rule import Rules
from fmukit.conformance.variable import ScalarVariable
from fmukit.conformance.xml_rules.group import reliable

RULES: Rules[Package] = Rules(reliable)


@RULES.add(
    "X30",
    "Inputs, parameters and constants have start values",
    "2.2.7",
    "Write start at every variable that is an input or whose initial is exact or approx.",
)
def _present(package: Package) -> Iterator[str]:
    for variable in package.variables:
        needed = variable.causality == "input" or variable.initial in ("exact", "approx")
        if needed and variable.start is None:
            what = variable.causality if variable.causality == "input" else f"initial {variable.initial}"
            yield f"variable {variable.name} ({what}) has no start value"


@RULES.add(
    "X31",
    "Calculated and independent variables have no start value",
    "2.2.7",
    'Take start out, or write initial="approx" or "exact" if the value matters.',
)
def _absent(package: Package) -> Iterator[str]:
    for variable in package.variables:
        forbidden = variable.initial == "calculated" or variable.causality == "independent"
        if forbidden and variable.start is not None:
            what = "independent" if variable.causality == "independent" else "calculated"
            yield f"variable {variable.name} is {what} and has the start value {variable.start}"


@RULES.add(
    "X32", "Start values are finite", "good practice", "Write a number; NaN and infinity are no values to start from."
)
def _finite(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if isinstance(variable.start, float) and not math.isfinite(variable.start):
            yield f"variable {variable.name} has the start value {variable.start}"


@RULES.add("X33", "Start values lie within min and max", "2.2.7", "Correct start, or widen min and max.")
def _within(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if isinstance(variable.start, (bool, str)) or variable.start is None or not math.isfinite(variable.start):
            continue
        low, high = _limits(variable)
        if low <= high and not low <= variable.start <= high:
            yield f"variable {variable.name} starts at {variable.start}, outside [{low}, {high}]"


@RULES.add(
    "X34",
    "Enumerations start at one of their items",
    "2.2.7",
    "Let start be the value of an Item of the declared type.",
)
def _item(package: Package) -> Iterator[str]:
    items = {
        kind.get("name"): {int(item.get("value")) for item in kind.iterfind("Enumeration/Item")}
        for kind in package.root.iterfind("TypeDefinitions/SimpleType[Enumeration]")
    }
    for variable in package.variables:
        legal = items.get(variable.declared_type)
        if variable.type == "Enumeration" and legal and variable.start is not None and variable.start not in legal:
            yield f"variable {variable.name} starts at {variable.start}, which is none of {sorted(legal)}"


@RULES.add("X35", "min is not above max", "2.2.7", "Exchange or correct min and max; neither may be NaN.")
def _order(package: Package) -> Iterator[str]:
    for variable in package.variables:
        low, high = _limits(variable)
        if not low <= high:
            yield f"variable {variable.name} has min {low} and max {high}"
    for kind in _numeric(package):
        low, high = float(kind[0].get("min", "-inf")), float(kind[0].get("max", "inf"))
        if not low <= high:
            yield f"type {kind.get('name')} has min {low:g} and max {high:g}"


@RULES.add(
    "X36", "Nominal values are positive and finite", "2.2.7", "Write the usual size of the variable, such as 100."
)
def _nominal(package: Package) -> Iterator[str]:
    for variable in package.variables:
        if variable.nominal is not None and not 0.0 < variable.nominal < math.inf:
            yield f"variable {variable.name} has the nominal value {variable.nominal}"
    for kind in _numeric(package):
        if not 0.0 < float(kind[0].get("nominal", "1")) < math.inf:
            yield f"type {kind.get('name')} has the nominal value {kind[0].get('nominal')}"


def _numeric(package: Package) -> list[Any]:
    """The definitions of types of numbers."""
    return [kind for kind in package.root.iterfind("TypeDefinitions/SimpleType") if kind[0].tag in ("Real", "Integer")]


def _limits(variable: ScalarVariable) -> tuple[float, float]:
    low = -math.inf if variable.min is None else variable.min
    return low, math.inf if variable.max is None else variable.max
