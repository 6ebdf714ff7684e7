"""The scalar variables of a description, with what the standard fills in where an attribute is missing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

Value = float | int | bool | str
TYPES = ("Real", "Integer", "Boolean", "String", "Enumeration")


@dataclass(frozen=True, slots=True)
class ScalarVariable:
    """One ScalarVariable. `index` counts from 1, `vr` is the value reference.

    `initial` is the default of the table in section 2.2.7 if not given, "" if there is none; `min`, `max`, `nominal`,
    `unit` come from the declared type if not given. `given` names the attributes that stand in the element itself.
    """

    index: int
    name: str
    vr: int
    type: str
    causality: str
    variability: str
    initial: str
    start: Value | None = None
    min: float | int | None = None
    max: float | int | None = None
    nominal: float | None = None
    unit: str | None = None
    display_unit: str | None = None
    declared_type: str | None = None
    derivative: int | None = None
    given: frozenset[str] = frozenset()

    @property
    def fmi_type(self) -> str:
        """The type whose get and set functions serve the variable."""
        return "Integer" if self.type == "Enumeration" else self.type

    @property
    def settable_before_start(self) -> bool:
        """Whether fmi2SetXXX may be called on it after instantiation (section 2.2.7)."""
        return self.variability != "constant" and (self.initial in ("exact", "approx") or self.causality == "input")


def read_variables(root: Any) -> tuple[ScalarVariable, ...]:
    """All variables of a description that follows the schema."""
    types = {kind.get("name"): dict(kind[0].attrib) for kind in root.iterfind("TypeDefinitions/SimpleType")}
    return tuple(_variable(i, element, types) for i, element in enumerate(root.iterfind("ModelVariables/*"), start=1))


def default_initial(causality: str, variability: str) -> str:
    """The default of `initial` (section 2.2.7, table of defaults); "" where there is none."""
    if causality in ("input", "independent"):
        return ""
    return "exact" if causality == "parameter" or variability == "constant" else "calculated"


def _variable(index: int, element: Any, types: Mapping[str, Mapping[str, str]]) -> ScalarVariable:
    typed = next(child for child in element if child.tag in TYPES)
    declared = typed.get("declaredType")
    values = {**types.get(declared, {}), **typed.attrib}
    causality, variability = element.get("causality", "local"), element.get("variability", "continuous")
    type_ = str(typed.tag)
    number = float if type_ == "Real" else int
    return ScalarVariable(
        index=index,
        name=element.get("name"),
        vr=int(element.get("valueReference")),
        type=type_,
        causality=causality,
        variability=variability,
        initial=element.get("initial", default_initial(causality, variability)),
        start=_value(type_, typed.get("start")),
        min=_number(number, values.get("min")),
        max=_number(number, values.get("max")),
        nominal=_number(float, values.get("nominal")),
        unit=values.get("unit"),
        display_unit=values.get("displayUnit"),
        declared_type=declared,
        derivative=_number(int, typed.get("derivative")),
        given=frozenset(map(str, (*element.attrib, *typed.attrib))),
    )


def _number(kind: Any, text: str | None) -> Any:
    return None if text is None else kind(text)


def _value(type_: str, text: str | None) -> Value | None:
    if text is None or type_ == "String":
        return text
    if type_ == "Boolean":
        return text.strip() in ("true", "1")
    return float(text) if type_ == "Real" else int(text)
