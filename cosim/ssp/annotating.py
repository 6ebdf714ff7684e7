"""Annotations of an exported system: OMSimulator's, without which it opens no SSP, and ours, read by `annotations`.

OMSimulator looks at the first annotation of a system only, and refuses any in a component. Its program wants an element
for the master; its Python interface takes the solver of the name it gives to co-simulation FMUs without one.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from xml.etree import ElementTree as ET

from cosim.model.clock import to_seconds
from cosim.model.face import Value
from cosim.model.node import Node
from cosim.ssp.namespaces import COSIM, OMS, SSC, SSD


def annotate(
    system: ET.Element,
    nodes: Mapping[str, Node],
    elements: Mapping[str, str],
    tick: int,
    interval: int,
    unrecorded: Iterable[str],
) -> None:
    """Add both annotations to the System; `elements` are names of components by instance, times in ns."""
    annotations = ET.SubElement(system, f"{{{SSD}}}Annotations")
    foreign = ET.SubElement(annotations, f"{{{SSC}}}Annotation", type="org.openmodelica")
    step, tolerance = repr(to_seconds(tick)), {"relativeTolerance": "0.0001"}
    solver = {"name": "oms_ma_default", "method": "oms_ma", "fixedStepSize": step} | tolerance
    both = ET.SubElement(foreign, f"{{{OMS}}}Annotations")
    information = ET.SubElement(both, f"{{{OMS}}}SimulationInformation", solver)
    master = {"description": "oms-ma", "stepSize": step, "absoluteTolerance": "0.0001"} | tolerance
    ET.SubElement(information, f"{{{OMS}}}FixedStepMaster", master)
    ours = ET.SubElement(annotations, f"{{{SSC}}}Annotation", type="cosim")
    root = ET.SubElement(ours, f"{{{COSIM}}}System")  # an annotation holds one element
    if interval:
        root.set("recordEvery", repr(to_seconds(interval)))
    for pattern in unrecorded:
        ET.SubElement(root, f"{{{COSIM}}}Unrecorded", pattern=pattern)
    for name, node in nodes.items():
        _instance(root, node, elements[name])
    for event in sorted(_events(nodes, elements), key=lambda event: float(event["time"])):
        ET.SubElement(root, f"{{{COSIM}}}Event", event)


def literal(value: Value) -> str:
    """The value as XML has it; a number comes back to the bit."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return repr(value) if isinstance(value, float) else str(value)


def _instance(root: ET.Element, node: Node, element: str) -> None:
    instance = ET.SubElement(root, f"{{{COSIM}}}Instance", element=element)
    if node.name != element:
        instance.set("name", node.name)
    instance.set("period", repr(to_seconds(node.period)))
    instance.set("kind", node.kind)


def _events(nodes: Mapping[str, Node], elements: Mapping[str, str]) -> Iterable[dict[str, str]]:
    """Values set during the run, in the units of the FMU."""
    for name, node in nodes.items():
        for change in node.changes:
            yield {
                "time": repr(to_seconds(change.time)),
                "element": elements[name],
                "connector": change.variable,
                "value": literal(change.value),
            }
