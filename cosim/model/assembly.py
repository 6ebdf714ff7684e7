"""From the values and wires of a system to checked nodes and connections: names, types, periods, units, events."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

from cosim.errors import CosimError, unknown
from cosim.model.clock import SECOND, nanoseconds
from cosim.model.configuration import LOOK, SAMPLE_PERIOD, Configuration, names, selected
from cosim.model.face import TYPES, Face, Kind, Port, Value
from cosim.model.patterns import matches_any
from cosim.model.system import Event, Instance, Link, Wire
from cosim.model.transformation import AS_IT_IS, Transformation
from cosim.model.units import conversion
from cosim.model.values import coerce

SEED = "seed"
_MAX_SEED = 2**31 - 1
_FITTING = {("Integer", "Real"), ("Enumeration", "Integer"), ("Integer", "Enumeration")}
"""Types of outputs and inputs that connect although they differ."""


@dataclass(frozen=True, slots=True)
class Connection:
    """One output to one input; `transformation` is what becomes of the value on its way."""

    source: str
    output: str
    target: str
    input: str
    transformation: Transformation = AS_IT_IS

    @property
    def text(self) -> str:
        return f"{self.source}.{self.output} -> {self.target}.{self.input}"


@dataclass(frozen=True, slots=True)
class Change:
    """The input `variable` takes `value` at `time` [ns]; the instance takes it in at `due` [ns].

    `signal` is how it was named: a name, or a pattern.
    """

    time: int
    due: int
    variable: str
    value: Value
    signal: str


@dataclass(slots=True)
class Node:
    """One instance of `model`, checked. `period` [ns]; `values` are set before initialisation; `incoming` by input.

    `changes` of unconnected inputs during the run, in order of time. `outputs` are those that are fetched, all numbers
    as doubles; `texts` are the Strings. An `isolated` one runs in a process of its own.
    """

    name: str
    model: str
    face: Face
    period: int
    kind: Kind
    values: dict[str, Value]
    incoming: dict[str, Connection] = field(default_factory=dict)
    changes: list[Change] = field(default_factory=list)
    outputs: tuple[str, ...] = ()
    texts: tuple[str, ...] = ()
    isolated: bool = False

    @property
    def incoming_numbers(self) -> list[Connection]:
        """Connections of inputs that are numbers, type by type."""
        return [c for name, c in self.incoming.items() if self.face.ports[name].type != "String"]

    @property
    def incoming_texts(self) -> list[Connection]:
        """Connections of String inputs."""
        return [c for name, c in self.incoming.items() if self.face.ports[name].type == "String"]

    def __post_init__(self) -> None:
        self.outputs, self.texts = self.face.numbers, self.face.texts


def assemble(configuration: Configuration, seed: int, step: float | None = None) -> dict[str, Node]:
    """The nodes of the configuration's system by instance name; raises CosimError for any mistake.

    `step` [s] is one communication step for all: models that keep their own sampling grid go on sampling on it.
    """
    system, faces = configuration.system, configuration.faces
    _one_each(system.instances, faces)
    nodes = {name: _node(name, instance, configuration, seed) for name, instance in system.instances.items()}
    if step is not None:
        for node in nodes.values():
            node.period = nanoseconds(step, "the common step")
    links = [_connection(link, nodes) for link in system.links]
    for connection in (*(found for wire in system.wires for found in _expand(wire, nodes)), *links):
        _attach(nodes[connection.target], connection)
    for node in nodes.values():
        node.incoming = dict(sorted(node.incoming.items(), key=partial(_place, node.face)))
    for node in nodes.values():
        for name in node.values.keys() & node.incoming.keys():
            raise _connected(node, name)
    for event in sorted(system.events, key=lambda event: event.time):
        for name, variable in selected(system, faces, event.signal, ("input",)):
            _schedule(nodes[name], event, variable)
    return nodes


def leave_out(nodes: Mapping[str, Node], patterns: Sequence[str]) -> None:
    """Outputs that nothing reads are not fetched if their signal fits a pattern such as **.tyre_force_x.fl."""
    read = {(connection.source, connection.output) for node in nodes.values() for connection in node.incoming.values()}
    for node in nodes.values():
        kept = {name for name in (*node.outputs, *node.texts) if not matches_any(f"{node.name}.{name}", patterns)}
        node.outputs = tuple(name for name in node.outputs if name in kept or (node.name, name) in read)
        node.texts = tuple(name for name in node.texts if name in kept or (node.name, name) in read)


def derived_seed(seed: int, instance: str) -> int:
    """The seed of one noisy instance: the same on every machine, different for every instance and run seed."""
    digest = hashlib.sha256(f"{seed}:{instance}".encode()).digest()
    return int.from_bytes(digest[:8], "big") % _MAX_SEED


def _node(name: str, instance: Instance, configuration: Configuration, seed: int) -> Node:
    face, values = configuration.faces[name], configuration.changed(name)
    if SEED in face.ports and face.ports[SEED].type == "Integer":
        values.setdefault(SEED, derived_seed(seed, name))
    period, kind = _period(name, instance, face, values), instance.kind or face.kind
    return Node(name, instance.model, face, period, kind, values, isolated=instance.isolated)


def _one_each(instances: Mapping[str, Instance], faces: Mapping[str, Face]) -> None:
    """Raises CosimError where two instances share a library that holds one at a time (FMI 2.0.4, 4.3.1)."""
    first: dict[str, str] = {}
    for name, instance in instances.items():
        alone = instance.isolated or not faces[name].single
        if not alone and first.setdefault(instance.model, name) != name:
            raise CosimError(
                f"{instance.model} can be instantiated only once per process, "
                f"but {first[instance.model]} and {name} are both instances of it; keep one, or `--isolate {name}`"
            )


def _period(name: str, instance: Instance, face: Face, values: Mapping[str, Value]) -> int:
    """The communication period [ns]: the system's, else the sampling period, else the model's default step."""
    step = instance.period if instance.period is not None else values.get(SAMPLE_PERIOD, face.step)
    if step is None:
        raise CosimError(f"{name} ({face.model}) has no default step; give the instance a period, or --period {name}=S")
    return nanoseconds(float(step), f"the period of {name} ({face.model})")


def _connected(node: Node, input_: str) -> CosimError:
    return CosimError(f"{node.name}.{input_} cannot be set, as it is connected: {node.incoming[input_].text}")


def _schedule(node: Node, event: Event, name: str) -> None:
    """The event sets the input `name` of the node; of two at one time the later one counts."""
    port = changing(node.name, node.face, name)
    if name in node.incoming:
        raise _connected(node, name)
    time = round(event.time * SECOND)
    due = -(-time // node.period) * node.period
    change = Change(time, due, name, coerce(event.signal, port, event.value), event.signal)
    node.changes = [other for other in node.changes if (other.time, other.variable) != (time, name)] + [change]


def changing(instance: str, face: Face, name: str) -> Port:
    """The input `name` of the instance, for a change during the run; raises CosimError where it is none."""
    port = face.ports.get(name)
    if port is None:
        raise unknown(f"input of {instance} ({face.model})", name, names(face, "input"), LOOK)
    if port.causality != "input":
        raise CosimError(f"{instance}.{name} cannot change during the run: it is no input of {face.model}")
    return port


def _expand(wire: Wire, nodes: Mapping[str, Node]) -> list[Connection]:
    source, target = nodes[wire.source], nodes[wire.target]
    found = []
    for name, port in target.face.ports.items():
        output = wire.counterpart(name) if port.causality == "input" else None
        if output is not None and _is_output(source.face, output):
            found.append(_connect(source, output, target, name))
    _all_named_found(wire, source, target, {connection.input for connection in found})
    return found


def _is_output(face: Face, name: str) -> bool:
    return name in face.ports and face.ports[name].causality == "output"


def _connection(link: Link, nodes: Mapping[str, Node]) -> Connection:
    """A link between ports that exist."""
    source, target = nodes[link.source], nodes[link.target]
    if not _is_output(source.face, link.output):
        raise _no_output(source, link.output)
    if link.input not in names(target.face, "input"):
        raise _no_input(target, link.input)
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


def _place(face: Face, incoming: tuple[str, Connection]) -> int:
    """Inputs are taken type by type, in the order of `TYPES`."""
    return TYPES.index(face.ports[incoming[0]].type)


def _all_named_found(wire: Wire, source: Node, target: Node, found: set[str]) -> None:
    """Every port a wire names in full must exist on both sides, and a wire must connect something."""
    for input_, output in wire.names.items():
        if input_ in found or input_ == "" or input_.endswith("."):
            continue
        raise _no_output(source, output) if input_ in names(target.face, "input") else _no_input(target, input_)
    if not found:
        raise CosimError(f"nothing connects {wire.source} to {wire.target}: no input of one is an output of the other")


def _no_input(node: Node, name: str) -> CosimError:
    return unknown(f"input of {node.name} ({node.face.model})", name, names(node.face, "input"), LOOK)


def _no_output(node: Node, name: str) -> CosimError:
    return unknown(f"output of {node.name} ({node.face.model})", name, names(node.face, "output"), LOOK)


def _attach(node: Node, connection: Connection) -> None:
    other = node.incoming.get(connection.input)
    if other is not None:
        raise CosimError(f"{node.name}.{connection.input} is fed twice: {other.text} and {connection.text}")
    node.incoming[connection.input] = connection
