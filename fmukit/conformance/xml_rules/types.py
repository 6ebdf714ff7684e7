"""TypeDefinitions and the variables declared with them."""

from __future__ import annotations

from collections.abc import Iterator

from fmukit.conformance.package import Package
from fmukit.conformance.rule import Rules
from fmukit.conformance.xml_rules.group import reliable, repeated

RULES: Rules[Package] = Rules(reliable)


@RULES.add(
    "X19",
    "Types have names of their own",
    "2.2.3",
    "Give every SimpleType another name, which is not the name of a variable either.",
)
def _unique(package: Package) -> Iterator[str]:
    names = [kind.get("name") for kind in package.root.iterfind("TypeDefinitions/SimpleType")]
    yield from (f"the type {name!r} is defined more than once" for name in repeated(names))
    variables = {variable.name for variable in package.variables}
    yield from (f"{name!r} is the name of a type and of a variable" for name in names if name in variables)


@RULES.add(
    "X20",
    "Declared types exist and are of the variable's type",
    "2.2.7",
    "Define the SimpleType, or correct declaredType: a Real variable needs a Real type.",
)
def _declared(package: Package) -> Iterator[str]:
    kinds = {kind.get("name"): kind[0].tag for kind in package.root.iterfind("TypeDefinitions/SimpleType")}
    for variable in package.variables:
        if variable.declared_type is None:
            continue
        if variable.declared_type not in kinds:
            yield f"variable {variable.name} has the declaredType {variable.declared_type!r}, which is not defined"
        elif kinds[variable.declared_type] != variable.type:
            kind = kinds[variable.declared_type]
            yield f"variable {variable.name} is {variable.type}, its declaredType {variable.declared_type!r} is {kind}"


@RULES.add(
    "X21",
    "Enumeration items have names and values of their own",
    "2.2.3",
    "Give each Item of the Enumeration another name and another value.",
)
def _items(package: Package) -> Iterator[str]:
    for kind in package.root.iterfind("TypeDefinitions/SimpleType[Enumeration]"):
        for attribute in ("name", "value"):
            for value in repeated(item.get(attribute).strip() for item in kind.iterfind("Enumeration/Item")):
                yield f"enumeration {kind.get('name')} has two items of the {attribute} {value!r}"
