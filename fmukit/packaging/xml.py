"""modelDescription.xml of a component: units, variables with limits and start values, model structure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from xml.etree.ElementTree import Element, SubElement, indent, tostring

from pythonfmu import Fmi2Slave, __version__

from fmukit.interface import Interface, Value, Variable
from fmukit.units import BASES, parse

_STOP_TIME = "10.0"


@dataclass(frozen=True, slots=True)
class About:
    """Who made the FMU; `date` is UTC in ISO 8601 with a final Z."""

    author: str
    version: str
    licence: str
    copyright: str
    date: str


def describe(interface: Interface, guid: str, about: About, initial: Mapping[str, Sequence[str]] | None) -> bytes:
    """The document. `initial` names the variables each output depends on at initialisation (None: unknown)."""
    root = _root(interface, guid, about)
    _unit_definitions(root, interface)
    _log_categories(root)
    SubElement(root, "DefaultExperiment", startTime="0.0", stopTime=_STOP_TIME, stepSize=repr(interface.step))
    variables = SubElement(root, "ModelVariables")
    for slot, variable in enumerate(interface.variables):
        _variable(variables, slot, variable, interface.kind)
    _structure(root, interface, initial)
    indent(root, "  ")
    return b'<?xml version="1.0" encoding="UTF-8"?>\n' + tostring(root, "utf-8") + b"\n"


def _root(interface: Interface, guid: str, about: About) -> Element:
    root = Element(
        "fmiModelDescription",
        fmiVersion="2.0",
        modelName=interface.name,
        guid=guid,
        description=interface.description,
        author=about.author,
        version=about.version,
        copyright=about.copyright,
        license=about.licence,
        generationTool=f"PythonFMU {__version__}",
        generationDateAndTime=about.date,
        variableNamingConvention="structured",
    )
    SubElement(
        root,
        "CoSimulation",
        modelIdentifier=interface.name,
        needsExecutionTool="true",
        canHandleVariableCommunicationStepSize="true",
        canInterpolateInputs="false",
        maxOutputDerivativeOrder="0",
        canRunAsynchronuously="false",
        canBeInstantiatedOnlyOncePerProcess="false",
        canNotUseMemoryManagementFunctions="true",
        canGetAndSetFMUstate="true",
        canSerializeFMUstate="true",
        providesDirectionalDerivative="false",
    )
    return root


def _unit_definitions(root: Element, interface: Interface) -> None:
    names = sorted({variable.unit for variable in interface.variables if variable.type == "Real"})
    if not names:
        return
    definitions = SubElement(root, "UnitDefinitions")
    for name in names:
        unit = parse(name)
        definition = SubElement(definitions, "Unit", name=name)
        if any(n.denominator != 1 for n in unit.exponents):
            continue  # FMI has whole exponents only; a unit without a BaseUnit is legal
        base = {key: str(n) for key, n in zip(BASES, unit.exponents, strict=True) if n}
        if unit.factor != 1.0:
            base["factor"] = repr(unit.factor)
        if unit.offset:
            base["offset"] = repr(unit.offset)
        SubElement(definition, "BaseUnit", base)


def _log_categories(root: Element) -> None:
    categories = SubElement(root, "LogCategories")
    for name, description in Fmi2Slave.log_categories.items():
        SubElement(categories, "Category", name=name, description=description)


def _variable(parent: Element, slot: int, variable: Variable, kind: str) -> None:
    moving = "continuous" if kind == "continuous" and variable.type == "Real" else "discrete"
    kinds = {
        "parameter": {"causality": "parameter", "variability": "fixed", "initial": "exact"},
        "input": {"causality": "input", "variability": moving},
        "output": {"causality": "output", "variability": moving, "initial": "calculated"},
    }
    description = variable.description + (f" [{variable.source}]" if variable.source else "")
    scalar = SubElement(
        parent,
        "ScalarVariable",
        {"name": variable.name, "valueReference": str(slot), "description": description, **kinds[variable.causality]},
    )
    SubElement(scalar, variable.type, _declaration(variable))


def _declaration(variable: Variable) -> dict[str, str]:
    declared: dict[str, str] = {}
    if variable.type == "Real":
        declared["unit"] = variable.unit
    if variable.type in ("Real", "Integer"):
        limits = {"min": variable.minimum, "max": variable.maximum}
        declared |= {key: _text(limit, variable.type) for key, limit in limits.items() if limit is not None}
    if variable.type == "Real" and variable.nominal is not None:
        declared["nominal"] = repr(float(variable.nominal))
    if variable.causality != "output":
        declared["start"] = _text(variable.start, variable.type)
    return declared


def _text(value: Value, type_: str) -> str:
    if type_ == "String":
        return str(value)
    if type_ == "Boolean":
        return "true" if value else "false"
    return str(int(value)) if type_ == "Integer" else repr(float(value))


def _structure(root: Element, interface: Interface, initial: Mapping[str, Sequence[str]] | None) -> None:
    index = {variable.name: str(i) for i, variable in enumerate(interface.variables, start=1)}
    structure = SubElement(root, "ModelStructure")
    outputs, unknowns = SubElement(structure, "Outputs"), SubElement(structure, "InitialUnknowns")
    for variable in interface.select("output"):
        SubElement(outputs, "Unknown", index=index[variable.name], dependencies="")
        unknown = SubElement(unknowns, "Unknown", index=index[variable.name])
        if initial is not None:
            unknown.set("dependencies", " ".join(index[name] for name in initial[variable.name]))
