"""What the master knows of a model before it runs: ports, units, kind and step, read from its modelDescription.xml."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Any, Literal

from fmpy.model_description import read_model_description
from lxml import etree

from cosim.errors import CosimError
from cosim.model.units import BASE, Unit
from fmukit.unpacking import ArchiveError, refuse_entities

Value = float | int | bool | str
Kind = Literal["continuous", "sampled"]
TYPES = ("Real", "Integer", "Enumeration", "Boolean", "String")
"""In the order in which the variables of an instance are taken and given."""


@dataclass(frozen=True, slots=True)
class Port:
    """One scalar variable of a model; `start` is its start value in the variable's own type, None without one.

    `relative`: its values are differences. `items` are the names and values of an Enumeration.
    """

    name: str
    reference: int
    causality: str
    type: str = "Real"
    variability: str = "continuous"
    unit: str | None = None
    relative: bool = False
    minimum: float | None = None
    maximum: float | None = None
    start: Value | None = None
    items: tuple[tuple[str, int], ...] = ()


@dataclass(frozen=True)
class Face:
    """One model. `step` is its default communication step [s]; None if it does not say.

    `single`: a process can hold one instance only. `whole_steps`: each step must be one communication period long.
    `begin` [s] is where its default experiment starts. `restorable`: its state can be saved and put back.
    """

    model: str
    ports: Mapping[str, Port]
    step: float | None
    units: Mapping[str, Unit] = field(default_factory=dict)
    identifier: str = ""
    guid: str = ""
    tool: str = ""
    single: bool = False
    whole_steps: bool = False
    begin: float = 0.0
    restorable: bool = False

    @cached_property
    def inputs(self) -> tuple[str, ...]:
        """Inputs, in the model's order."""
        return tuple(p.name for p in self.ports.values() if p.causality == "input")

    @cached_property
    def outputs(self) -> tuple[str, ...]:
        """Real outputs, in the model's order."""
        return tuple(p.name for p in self.ports.values() if p.causality == "output" and p.type == "Real")

    @cached_property
    def numbers(self) -> tuple[str, ...]:
        """All outputs but Strings, type by type, Real ones first."""
        return tuple(
            p.name for type_ in TYPES[:-1] for p in self.ports.values() if (p.causality, p.type) == ("output", type_)
        )

    @cached_property
    def texts(self) -> tuple[str, ...]:
        """String outputs, in the model's order."""
        return tuple(p.name for p in self.ports.values() if (p.causality, p.type) == ("output", "String"))

    @cached_property
    def kind(self) -> Kind:
        """Continuous if any Real output varies continuously."""
        varied = any(self.ports[name].variability == "continuous" for name in self.outputs)
        return "continuous" if varied else "sampled"

    def unit(self, name: str) -> Unit | None:
        port = self.ports[name]
        if port.unit is None:
            return None
        return replace(self.units.get(port.unit, Unit(port.unit)), relative=port.relative)


def read_face(folder: Path, origin: Path) -> Face:
    """The face of the FMU unpacked in `folder`; errors name `origin`, the file it came from."""
    xml = folder / "modelDescription.xml"
    if not xml.is_file():
        raise CosimError(f"{origin} has no modelDescription.xml, so it is not an FMU")
    try:
        data = xml.read_bytes()
        refuse_entities(xml.name, data)
        description = read_model_description(str(folder))
        _read_relative(description, data)
    except ArchiveError as error:
        raise CosimError(f"{origin}: {error}") from None
    except Exception as error:
        raise CosimError(f"{origin} has an invalid modelDescription.xml: {_one_line(error)}") from None
    return _face(description, origin)


def _read_relative(description: Any, data: bytes) -> None:
    """Give the variables their relativeQuantity: FMPy looks for the attribute among the children of the element."""
    said = {
        kind.getparent().get("name"): kind.get("relativeQuantity") in ("true", "1")
        for kind in etree.fromstring(data).iterfind("ModelVariables/ScalarVariable/Real[@relativeQuantity]")
    }
    for variable in description.modelVariables:
        variable.relativeQuantity = said.get(variable.name)


def _face(description: Any, origin: Path) -> Face:
    if description.fmiVersion != "2.0":
        raise CosimError(f"{origin} is for FMI {description.fmiVersion}; only FMI 2.0 can run")
    if description.coSimulation is None:
        raise CosimError(f"{origin} is for model exchange only; a co-simulation FMU is needed")
    experiment = description.defaultExperiment
    step = experiment.stepSize if experiment else None
    return Face(
        model=description.modelName,
        ports={variable.name: _port(variable) for variable in description.modelVariables},
        step=None if step is None else float(step),
        units={unit.name: _unit(unit) for unit in description.unitDefinitions},
        identifier=description.coSimulation.modelIdentifier,
        guid=description.guid,
        tool=description.generationTool or "",
        single=description.coSimulation.canBeInstantiatedOnlyOncePerProcess,
        whole_steps=not description.coSimulation.canHandleVariableCommunicationStepSize,
        begin=_begin(experiment),
        restorable=description.coSimulation.canGetAndSetFMUstate and description.coSimulation.canSerializeFMUstate,
    )


def _port(variable: Any) -> Port:
    declared = variable.declaredType
    unit, relative, low, high = (
        getattr(variable, name) if getattr(variable, name) is not None or declared is None else getattr(declared, name)
        for name in ("unit", "relativeQuantity", "min", "max")
    )
    return Port(
        name=variable.name,
        reference=variable.valueReference,
        causality=variable.causality or "local",
        type=variable.type,
        variability=variable.variability or ("continuous" if variable.type == "Real" else "discrete"),
        unit=unit,
        relative=bool(relative),
        minimum=None if low is None else float(low),
        maximum=None if high is None else float(high),
        start=_start(variable.type, variable.start),
        items=() if declared is None else tuple((item.name, int(item.value)) for item in declared.items),
    )


def _begin(experiment: Any) -> float:
    try:
        return float(experiment.startTime or 0.0)
    except (AttributeError, ValueError):  # there is no experiment, or its start is no number
        return 0.0


def _start(type_: str, text: str | None) -> Value | None:
    """A start value in the variable's own type; None for one that is not there or not readable."""
    if text is None or type_ == "String":
        return text
    try:
        number = float({"true": "1", "false": "0"}.get(text, text))
    except ValueError:
        return None
    return {"Real": float, "Boolean": bool}.get(type_, int)(number)


def _unit(unit: Any) -> Unit:
    base = unit.baseUnit
    if base is None:
        return Unit(unit.name)
    exponents = tuple(int(getattr(base, name) or 0) for name in BASE)
    return Unit(unit.name, exponents, float(base.factor), float(base.offset))


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())[:300]
