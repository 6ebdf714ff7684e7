"""The XML of an exported system: the description of its structure and the values of its instances."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from xml.etree import ElementTree as ET

from cosim.errors import CosimError
from cosim.model.clock import to_seconds
from cosim.model.face import Port
from cosim.model.node import Connection, Node
from cosim.model.transformation import Lookup
from cosim.model.units import BASE, Unit
from cosim.ssp.annotating import annotate, literal
from cosim.ssp.names import identifiers, uri
from cosim.ssp.namespaces import PREFIXES, SSC, SSD, SSV
from cosim.ssp.packing import Model

PARAMETERS = "parameters"  # one name for all sets: some tools choose by name which to apply
Items = tuple[tuple[str, int], ...]


@dataclass(frozen=True, slots=True)
class Outline:
    """What is written: the `nodes` of the system called `name`, and by their names the `models` of their FMUs, the

    members with their parameter `sets`, and the names of their `elements`, which are identifiers. Times in ns: the end
    of the run, the `tick` that divides all periods, and the `interval` of recorded rows.
    """

    name: str
    nodes: Mapping[str, Node]
    models: Mapping[str, Model]
    sets: Mapping[str, str]
    elements: Mapping[str, str]
    stop: int
    tick: int = 1_000_000
    interval: int = 0


def structure(outline: Outline, unrecorded: Iterable[str] = ()) -> bytes:
    """SystemStructure.ssd; `unrecorded` are patterns of signals that are left out of results."""
    name = identifiers([outline.name])[outline.name]
    root = ET.Element(f"{{{SSD}}}SystemStructureDescription", version="1.0", name=name, generationTool="cosim")
    system = ET.SubElement(root, f"{{{SSD}}}System", name=name)
    elements = ET.SubElement(system, f"{{{SSD}}}Elements")
    shown = _shown(outline.nodes)
    enumerations, units = _enumerations(shown.values()), _units(outline.nodes, shown)
    for instance, node in outline.nodes.items():
        component = _component(elements, outline, instance)
        _connectors(component, node, shown[instance], enumerations, units)
        _bindings(component, outline.sets.get(instance))
    _connections(system, outline)
    annotate(system, outline.nodes, outline.elements, outline.tick, outline.interval, unrecorded)
    _define_enumerations(root, enumerations)
    _define_units(root, units)
    experiment = {"startTime": "0.0", "stopTime": repr(to_seconds(outline.stop))}
    ET.SubElement(root, f"{{{SSD}}}DefaultExperiment", experiment)
    return _text(root)


def values(node: Node) -> bytes:
    """The parameter set (SSV) of one node, in the units of its FMU.

    Enumerations are numbers there: FMI 2.0 sets them as Integers, and Ecos opens no other.
    """
    root = ET.Element(f"{{{SSV}}}ParameterSet", version="1.0", name=PARAMETERS)
    parameters = ET.SubElement(root, f"{{{SSV}}}Parameters")
    for name, value in node.values.items():
        type_ = node.face.ports[name].type
        parameter = ET.SubElement(parameters, f"{{{SSV}}}Parameter", name=name)
        kind = "Integer" if type_ == "Enumeration" else type_
        ET.SubElement(parameter, f"{{{SSV}}}{kind}", value=literal(value))
    return _text(root)


def _type(port: Port) -> str:
    """An Enumeration without items is a number."""
    return "Integer" if port.type == "Enumeration" and not port.items else port.type


def _component(elements: ET.Element, outline: Outline, instance: str) -> ET.Element:
    attributes = {
        "name": outline.elements[instance],
        "type": "application/x-fmu-sharedlibrary",
        "source": uri(f"resources/{outline.models[instance].name}"),
        "implementation": "CoSimulation",
    }
    return ET.SubElement(elements, f"{{{SSD}}}Component", attributes)


def _connectors(
    component: ET.Element, node: Node, shown: list[Port], enumerations: Mapping[Items, str], units: Mapping[str, Unit]
) -> None:
    """Connectors for the ports; a unit that another FMU defines otherwise is left to the FMU."""
    connectors = ET.SubElement(component, f"{{{SSD}}}Connectors") if shown else component
    for port in shown:
        connector = ET.SubElement(connectors, f"{{{SSD}}}Connector", name=port.name, kind=port.causality)
        kind = ET.SubElement(connector, f"{{{SSC}}}{_type(port)}")
        if port.type == "Real" and port.unit is not None and _defined(node, port.unit) == units[port.unit]:
            kind.set("unit", port.unit)
        if _type(port) == "Enumeration":
            kind.set("name", enumerations[port.items])


def _bindings(component: ET.Element, member: str | None) -> None:
    if member is not None:
        bindings = ET.SubElement(component, f"{{{SSD}}}ParameterBindings")
        source = {"type": "application/x-ssp-parameter-set", "source": uri(member)}
        ET.SubElement(bindings, f"{{{SSD}}}ParameterBinding", source)


def _shown(nodes: Mapping[str, Node]) -> dict[str, list[Port]]:
    """The ports that have connectors: inputs and outputs, but Enumerations, which few tools know, only if connected."""
    found = [connection for node in nodes.values() for connection in node.connections]
    joined = {(c.source, c.output) for c in found} | {(c.target, c.input) for c in found}
    return {
        name: [
            port
            for port in node.face.ports.values()
            if (name, port.name) in joined or (port.causality in ("input", "output") and port.type != "Enumeration")
        ]
        for name, node in nodes.items()
    }


def _connections(system: ET.Element, outline: Outline) -> None:
    found = [connection for node in outline.nodes.values() for connection in node.connections]
    parent = ET.SubElement(system, f"{{{SSD}}}Connections") if found else system
    for connection in found:
        ends = {
            "startElement": outline.elements[connection.source],
            "startConnector": connection.output,
            "endElement": outline.elements[connection.target],
            "endConnector": connection.input,
        }
        _transform(ET.SubElement(parent, f"{{{SSD}}}Connection", ends), connection, outline.nodes)


def _transform(element: ET.Element, connection: Connection, nodes: Mapping[str, Node]) -> None:
    """A conversion of units is written out, as not every tool converts by itself."""
    linear, steps = connection.transformation.linear, connection.transformation.steps
    if linear is not None:
        if not linear.trivial:
            element.set("suppressUnitConversion", "true")
            factor, offset = repr(linear.factor), repr(linear.offset)
            ET.SubElement(element, f"{{{SSC}}}LinearTransformation", factor=factor, offset=offset)
        return
    lookup = steps[0]
    if len(steps) > 1 or not isinstance(lookup, Lookup):
        raise CosimError(f"{connection.text} has {len(steps)} steps on its way, and a connection of SSP at most one")
    output = nodes[connection.source].face.ports[connection.output]
    kind, entries = _map(lookup, output, nodes[connection.target].face.ports[connection.input])
    parent = ET.SubElement(element, f"{{{SSC}}}{kind}MappingTransformation")
    for source, target in entries:
        ET.SubElement(parent, f"{{{SSC}}}MapEntry", source=source, target=target)


def _map(lookup: Lookup, source: Port, target: Port) -> tuple[str, list[tuple[str, str]]]:
    """The kind of a map and its entries: by names for Enumerations that have them, else by numbers."""
    if source.type == target.type == "Boolean":
        return "Boolean", [(literal(bool(a)), literal(bool(b))) for a, b in lookup.entries]
    names, others = ({number: item for item, number in port.items} for port in (source, target))
    if names and others and all(a in names and b in others for a, b in lookup.entries):
        return "Enumeration", [(names[a], others[b]) for a, b in lookup.entries]
    return "Integer", [(str(a), str(b)) for a, b in lookup.entries]


def _enumerations(shown: Iterable[list[Port]]) -> dict[Items, str]:
    """A name for the items of every enumeration of a connector."""
    found = {port.items: None for ports in shown for port in ports if _type(port) == "Enumeration"}
    return {items: f"Enumeration{number}" for number, items in enumerate(found, start=1)}


def _define_enumerations(root: ET.Element, enumerations: Mapping[Items, str]) -> None:
    parent = ET.SubElement(root, f"{{{SSD}}}Enumerations") if enumerations else root
    for items, name in enumerations.items():
        enumeration = ET.SubElement(parent, f"{{{SSC}}}Enumeration", name=name)
        for item, number in items:
            ET.SubElement(enumeration, f"{{{SSC}}}Item", name=item, value=str(number))


def _units(nodes: Mapping[str, Node], shown: Mapping[str, list[Port]]) -> dict[str, Unit]:
    """The units of all connectors; of two definitions under one name the first."""
    used: dict[str, Unit] = {}
    for name, node in nodes.items():
        for port in shown[name]:
            if port.unit is not None and port.type == "Real":
                used.setdefault(port.unit, _defined(node, port.unit))
    return used


def _defined(node: Node, unit: str) -> Unit:
    return node.face.units.get(unit, Unit(unit))


def _define_units(root: ET.Element, units: Mapping[str, Unit]) -> None:
    parent = ET.SubElement(root, f"{{{SSD}}}Units") if units else root
    for name in sorted(units):
        unit = ET.SubElement(parent, f"{{{SSC}}}Unit", name=name)
        base = ET.SubElement(unit, f"{{{SSC}}}BaseUnit")
        for symbol, exponent in zip(BASE, units[name].exponents or (), strict=False):
            if exponent:
                base.set(symbol, str(exponent))
        if units[name].factor != 1.0:
            base.set("factor", repr(units[name].factor))
        if units[name].offset != 0.0:
            base.set("offset", repr(units[name].offset))


def _text(root: ET.Element) -> bytes:
    for prefix, namespace in PREFIXES.items():
        ET.register_namespace(prefix, namespace)
    ET.indent(root)
    return bytes(ET.tostring(root, "UTF-8", xml_declaration=True)) + b"\n"
