"""A system as SSP 1.0: SystemStructure.ssd with the FMUs and one set of parameter values per instance in resources/.

Other tools read everything they need from it. What SSP 1.0 has no place for, the communication period of an instance
and values that change during the run, is an annotation of type "cosim". Tables named by String parameters travel in the
resources of the FMU that reads them.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from xml.etree import ElementTree as ET

from cosim.engine.loader import Loader
from cosim.errors import CosimError
from cosim.model.assembly import Connection, Node
from cosim.model.clock import to_seconds
from cosim.model.face import Port, Value
from cosim.model.units import BASE, Unit
from cosim.run.prepare import plan
from cosim.run.request import Request
from cosim.ssp.names import free_name, uri
from cosim.ssp.packing import Model, packed, take_tables_along
from fmukit.errors import because
from fmukit.files import write
from fmukit.packing import pack

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
COSIM = "urn:cosim"
PARAMETERS = "parameters"  # one name for all sets: some tools choose by name which to apply
_PREFIXES = {"ssd": SSD, "ssc": SSC, "ssv": SSV, "cosim": COSIM}
_LOG = logging.getLogger("cosim")


def export(request: Request, file: Path) -> Path:
    """Write the scenario as `file` (.ssp) and return it; raises CosimError. Equal requests give equal bytes."""
    with Loader(request.find) as loader:
        nodes = plan(request, loader).nodes
        models = _models({name: loader.file(node.model) for name, node in nodes.items()})
    for node in nodes.values():
        take_tables_along(node, models[node.name])
    _tell_what_is_lost(nodes)
    members = {f"resources/{model.name}": packed(model) for model in models.values()}
    sets = _sets(nodes)
    members["SystemStructure.ssd"] = structure(request.scenario.name, nodes, models, sets, to_seconds(request.stop))
    members |= {member: values(nodes[name]) for name, member in sets.items()}
    try:
        return write(file, pack(members))
    except OSError as error:
        raise CosimError(f"cannot write {file}: {because(error)}") from None


def structure(
    name: str, nodes: Mapping[str, Node], models: Mapping[str, Model], sets: Mapping[str, str], stop: float
) -> bytes:
    """SystemStructure.ssd of the nodes; `models` and members with parameter `sets` by instance name, `stop` [s]."""
    root = ET.Element(f"{{{SSD}}}SystemStructureDescription", version="1.0", name=name, generationTool="cosim")
    system = ET.SubElement(root, f"{{{SSD}}}System", name=name)
    elements = ET.SubElement(system, f"{{{SSD}}}Elements")
    for node in nodes.values():
        _component(elements, node, models[node.name], sets.get(node.name))
    _connections(system, nodes.values())
    _events(system, nodes.values())
    _units(root, nodes.values())
    ET.SubElement(root, f"{{{SSD}}}DefaultExperiment", startTime="0.0", stopTime=repr(float(stop)))
    return _text(root)


def values(node: Node) -> bytes:
    """The parameter set (SSV) of one node, in the units of its FMU."""
    root = ET.Element(f"{{{SSV}}}ParameterSet", version="1.0", name=PARAMETERS)
    parameters = ET.SubElement(root, f"{{{SSV}}}Parameters")
    for name, value in node.values.items():
        parameter = ET.SubElement(parameters, f"{{{SSV}}}Parameter", name=name)
        ET.SubElement(parameter, f"{{{SSV}}}{node.face.ports[name].type}", value=_literal(value))
    return _text(root)


def _models(files: Mapping[str, Path]) -> dict[str, Model]:
    """A name of its own in resources/ for every file: the file's, numbered where two files share it."""
    models: dict[Path, Model] = {}
    for file in files.values():
        if file not in models:
            taken = {model.name.casefold() for model in models.values()}
            models[file] = Model(file, free_name(file.stem, ".fmu", taken))
    return {instance: models[file] for instance, file in files.items()}


def _sets(nodes: Mapping[str, Node]) -> dict[str, str]:
    """The member that holds the parameter set of each instance with values of its own."""
    names: dict[str, str] = {}
    for node in nodes.values():
        if node.values:
            names[node.name] = free_name(node.name, ".ssv", {name.casefold() for name in names.values()})
    return {instance: f"resources/{name}" for instance, name in names.items()}


def _tell_what_is_lost(nodes: Mapping[str, Node]) -> None:
    count = sum(len(node.changes) for node in nodes.values())
    if count:
        values = "1 value that changes" if count == 1 else f"{count} values that change"
        _LOG.warning(
            "SSP 1.0 has no place for %s during the run: an annotation keeps it, other tools ignore it", values
        )


def _component(elements: ET.Element, node: Node, model: Model, values_file: str | None) -> None:
    component = ET.SubElement(
        elements,
        f"{{{SSD}}}Component",
        name=node.name,
        type="application/x-fmu-sharedlibrary",
        source=uri(f"resources/{model.name}"),
        implementation="CoSimulation",
    )
    connectors = ET.SubElement(component, f"{{{SSD}}}Connectors")
    for port in node.face.ports.values():
        if port.causality in ("input", "output"):
            _connector(connectors, port)
    if values_file is not None:
        bindings = ET.SubElement(component, f"{{{SSD}}}ParameterBindings")
        ET.SubElement(
            bindings,
            f"{{{SSD}}}ParameterBinding",
            type="application/x-ssp-parameter-set",
            source=uri(values_file),
        )
    annotations = ET.SubElement(component, f"{{{SSD}}}Annotations")
    annotation = ET.SubElement(annotations, f"{{{SSC}}}Annotation", type="cosim")
    ET.SubElement(annotation, f"{{{COSIM}}}Communication", period=repr(to_seconds(node.period)))


def _connector(connectors: ET.Element, port: Port) -> None:
    connector = ET.SubElement(connectors, f"{{{SSD}}}Connector", name=port.name, kind=port.causality)
    kind = ET.SubElement(connector, f"{{{SSC}}}{port.type}")
    if port.unit is not None:
        kind.set("unit", port.unit)


def _connections(system: ET.Element, nodes: Iterable[Node]) -> None:
    found = [connection for node in nodes for connection in node.incoming.values()]
    parent = ET.SubElement(system, f"{{{SSD}}}Connections") if found else system
    for connection in found:
        _connection(parent, connection)


def _connection(parent: ET.Element, connection: Connection) -> None:
    """A conversion of units is written out, as not every tool converts by itself."""
    ends = {
        "startElement": connection.source,
        "startConnector": connection.output,
        "endElement": connection.target,
        "endConnector": connection.input,
    }
    element = ET.SubElement(parent, f"{{{SSD}}}Connection", ends)
    linear = connection.transformation.linear
    if linear is not None and not linear.trivial:
        element.set("suppressUnitConversion", "true")
        factor, offset = repr(linear.factor), repr(linear.offset)
        ET.SubElement(element, f"{{{SSC}}}LinearTransformation", factor=factor, offset=offset)


def _events(system: ET.Element, nodes: Iterable[Node]) -> None:
    """Values set during the run, in the units of the FMU."""
    found = [(change, node) for node in nodes for change in node.changes]
    if not found:
        return
    annotations = ET.SubElement(system, f"{{{SSD}}}Annotations")
    annotation = ET.SubElement(annotations, f"{{{SSC}}}Annotation", type="cosim")
    parent = ET.SubElement(annotation, f"{{{COSIM}}}Events")  # an annotation holds one element
    for change, node in sorted(found, key=lambda pair: pair[0].time):
        time, value = repr(to_seconds(change.time)), _literal(change.value)
        names = {"time": time, "element": node.name, "connector": change.variable, "value": value}
        ET.SubElement(parent, f"{{{COSIM}}}Event", names)


def _units(root: ET.Element, nodes: Iterable[Node]) -> None:
    """The units of all connectors; of two definitions under one name the first is taken."""
    ports = ((node.face, port) for node in nodes for port in node.face.ports.values())
    used: dict[str, Unit] = {}
    for face, port in ports:
        if port.unit is not None and port.causality in ("input", "output"):
            used.setdefault(port.unit, face.units.get(port.unit, Unit(port.unit)))
    parent = ET.SubElement(root, f"{{{SSD}}}Units") if used else root
    for name in sorted(used):
        unit = ET.SubElement(parent, f"{{{SSC}}}Unit", name=name)
        base = ET.SubElement(unit, f"{{{SSC}}}BaseUnit")
        for symbol, exponent in zip(BASE, used[name].exponents or (), strict=False):
            if exponent:
                base.set(symbol, str(exponent))
        if used[name].factor != 1.0:
            base.set("factor", repr(used[name].factor))
        if used[name].offset != 0.0:
            base.set("offset", repr(used[name].offset))


def _literal(value: Value) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float) and math.isfinite(value):
        return repr(value)
    return str(value)


def _text(root: ET.Element) -> bytes:
    for prefix, namespace in _PREFIXES.items():
        ET.register_namespace(prefix, namespace)
    ET.indent(root)
    return bytes(ET.tostring(root, "UTF-8", xml_declaration=True)) + b"\n"
