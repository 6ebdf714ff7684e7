"""From wires and links to connections between ports that exist and fit."""

from __future__ import annotations

from collections.abc import Mapping

from cosim.errors import CosimError, unknown
from cosim.model.configuration import LOOK, names
from cosim.model.face import Face
from cosim.model.node import Connection, Node
from cosim.model.system import Link, Wire
from cosim.model.transformation import AS_IT_IS, Transformation
from cosim.model.units import conversion

_FITTING = {("Integer", "Real"), ("Enumeration", "Integer"), ("Integer", "Enumeration")}
"""Types of outputs and inputs that connect although they differ."""


def expanded(wire: Wire, nodes: Mapping[str, Node]) -> list[Connection]:
    source, target = nodes[wire.source], nodes[wire.target]
    found = []
    for name, port in target.face.ports.items():
        output = wire.counterpart(name) if port.causality == "input" else None
        if output is not None and _is_output(source.face, output):
            found.append(_connect(source, output, target, name))
    if not wire.lenient:
        _all_named_found(wire, source, target, {connection.input for connection in found})
    return found


def _is_output(face: Face, name: str) -> bool:
    return name in face.ports and face.ports[name].causality == "output"


def linked(link: Link, nodes: Mapping[str, Node]) -> Connection:
    """A link between ports that exist: what an instance calculates when it initialises also feeds parameters."""
    source, target = nodes[link.source], nodes[link.target]
    early = link.output in names(source.face, "calculatedParameter")
    if not (early or _is_output(source.face, link.output)):
        raise _no_output(source, link.output)
    if link.input not in names(target.face, "input", *(["parameter"] if early else [])):
        raise no_input(target, link.input)
    return _connect(source, link.output, target, link.input, link.transformation)


def _connect(
    source: Node, output: str, target: Node, input_: str, transformation: Transformation | None = None
) -> Connection:
    where = f"{source.name}.{output} -> {target.name}.{input_}"
    types = source.face.ports[output].type, target.face.ports[input_].type
    if types[0] != types[1] and types not in _FITTING and not (transformation and transformation.steps):
        raise CosimError(f"{where}: one is {types[0]}, the other {types[1]}; connect ports of one type")
    if "String" in types and types[0] != types[1]:
        raise CosimError(f"{where}: one is {types[0]}, the other {types[1]}; a String connects to Strings only")
    if transformation is None:
        convert = conversion(source.face.unit(output), target.face.unit(input_), where)
        transformation = AS_IT_IS.then(convert)
    return Connection(source.name, output, target.name, input_, transformation)


def _all_named_found(wire: Wire, source: Node, target: Node, found: set[str]) -> None:
    """Every port a wire names in full must exist on both sides, and a wire must connect something."""
    for input_, output in wire.names.items():
        if input_ in found or input_ == "" or input_.endswith("."):
            continue
        raise _no_output(source, output) if input_ in names(target.face, "input") else no_input(target, input_)
    if not found:
        raise CosimError(f"nothing connects {wire.source} to {wire.target}: no input of one is an output of the other")


def no_input(node: Node, name: str) -> CosimError:
    return unknown(f"input of {node.name} ({node.face.model})", name, names(node.face, "input"), LOOK)


def _no_output(node: Node, name: str) -> CosimError:
    return unknown(f"output of {node.name} ({node.face.model})", name, names(node.face, "output"), LOOK)


def attach(nodes: Mapping[str, Node], connection: Connection) -> None:
    """Let the connection feed its target; raises CosimError where something else does."""
    source, node = nodes[connection.source], nodes[connection.target]
    once = node.face.ports[connection.input].causality == "parameter"
    feeding = node.given if once else node.incoming
    other = feeding.get(connection.input)
    if other is not None:
        raise CosimError(f"{node.name}.{connection.input} is fed twice: {other.text} and {connection.text}")
    feeding[connection.input] = connection
    if not _is_output(source.face, connection.output):
        source.show(connection.output)
