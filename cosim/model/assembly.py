"""From the values and wires of a system to checked nodes and connections: names, types, periods, units, events."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping, Sequence

from cosim.errors import CosimError, unknown
from cosim.model.clock import SECOND, nanoseconds
from cosim.model.configuration import LOOK, SAMPLE_PERIOD, Configuration, names, selected
from cosim.model.effects import Delay, Drop, Freeze, Override
from cosim.model.face import Face, Port, Value
from cosim.model.fault import Fault
from cosim.model.node import Change, Connection, Node, place
from cosim.model.patterns import matches_any
from cosim.model.system import Event, Instance
from cosim.model.values import coerce
from cosim.model.wiring import attach, expanded, linked, no_input

SEED = "seed"
_MAX_SEED = 2**31 - 1


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
    links = [linked(link, nodes) for link in system.links]
    for connection in (*(found for wire in system.wires for found in expanded(wire, nodes)), *links):
        attach(nodes, connection)
    for node in nodes.values():
        node.incoming = dict(sorted(node.incoming.items(), key=lambda item: place(node.face, item[0])))
    for node in nodes.values():
        for connection in node.connections:
            if connection.input in node.values:
                raise _connected(node, connection)
    for event in sorted(system.events, key=lambda event: event.time):
        for name, variable in selected(system, faces, event.signal, ("input",)):
            _schedule(nodes[name], event, variable)
    for fault in system.faults:
        for name, variable in selected(system, faces, fault.signal, ("input",)):
            text = variable in faces[name].ports and faces[name].ports[variable].type == "String"
            if not text or fault.signal == f"{name}.{variable}":  # of a pattern, texts are not meant
                _fail(nodes[name], variable, fault)
    _check_conditions(nodes)
    return nodes


def leave_out(nodes: Mapping[str, Node], patterns: Sequence[str]) -> None:
    """Outputs that nothing reads are not fetched if their signal fits a pattern such as **.tyre_force_x.fl."""
    read = {(connection.source, connection.output) for node in nodes.values() for connection in node.connections}
    read |= {place for node in nodes.values() for place in _watched(node, nodes)}
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
    return Node(name, instance.model, face, period, kind, values, isolated=instance.isolated, seed=seed)


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


def _connected(node: Node, connection: Connection) -> CosimError:
    return CosimError(f"{node.name}.{connection.input} cannot be set, as it is connected: {connection.text}")


def _schedule(node: Node, event: Event, name: str) -> None:
    """The event sets the input `name` of the node; of two at one time the later one counts."""
    port = changing(node.name, node.face, name)
    if name in node.incoming:
        raise _connected(node, node.incoming[name])
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


def _fail(node: Node, name: str, fault: Fault) -> None:
    """The input `name` of the node has the fault."""
    where, port = f"{node.name}.{name}", node.face.ports.get(name)
    if port is None or port.causality != "input":
        raise no_input(node, name)
    if port.type == "String":
        raise CosimError(f"{where} is a String, which can only be set: give the event `set`")
    if port.type in ("Boolean", "Enumeration") and not isinstance(fault.effect, Override | Freeze | Delay | Drop):
        raise CosimError(f"{where} is {port.type}, which can be overridden, frozen, delayed or dropped, nothing else")
    for value in fault.effect.values:
        coerce(where, port, int(value) if port.items and value == round(value) else value)
    if any(change.variable == name for change in node.changes):
        raise CosimError(f"{where} is set by one event and changed by another; give it one kind of event only")
    node.faults.setdefault(name, []).append(fault)


def _check_conditions(nodes: Mapping[str, Node]) -> None:
    """Raises CosimError for a condition on a signal that is no number of the system."""
    found = [each for node in nodes.values() for faults in node.faults.values() for f in faults for each in f.when]
    if not found:
        return
    known = {f"{node.name}.{name}" for node in nodes.values() for name in (*node.face.numbers, *node.faults)}
    known |= {f"{node.name}.{change.variable}" for node in nodes.values() for change in node.changes}
    for each in found:
        if each.signal not in known:
            raise unknown("signal of a condition", each.signal, known, "outputs, and inputs that events change")


def _watched(node: Node, nodes: Mapping[str, Node]) -> Iterator[tuple[str, str]]:
    """Outputs that conditions of the node's faults look at."""
    signals = {each.signal for faults in node.faults.values() for fault in faults for each in fault.when}
    for other in nodes.values() if signals else ():
        yield from ((other.name, output) for output in other.face.numbers if f"{other.name}.{output}" in signals)
