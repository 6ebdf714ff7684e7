"""From a tree of systems to one flat system: instances named by their paths, links, and values before the start."""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping

from cosim.errors import CosimError, unknown
from cosim.model.face import Face, Kind, Port, Value
from cosim.model.system import System
from cosim.model.transformation import AS_IT_IS, Transformation
from cosim.model.units import Unit, conversion
from cosim.model.values import coerce
from cosim.ssp.bindings import Given, given
from cosim.ssp.carrying import Measured, arrived, carried, value_of
from cosim.ssp.network import Edge, Network, Node, ends, networked
from cosim.ssp.structure import Annotated, Told, Tree

_LOG = logging.getLogger("cosim")
_SETTABLE = ("parameter", "input")


def flattened(root: Tree, faces: Mapping[str, Face], told: Annotated) -> System:
    """The system of the tree; `faces` are by model. Raises CosimError for what cannot be connected or set."""
    network = networked(root, faces)
    if not network.components:
        raise CosimError(f"{root.where}: the system {root.name!r} has no component, so nothing can run")
    names = _names(network, told)
    system = System()
    said = {each.element: each for each in told.instances}
    for path, component in network.components.items():
        extra = said.get(".".join(path))
        period, kind = (None, None) if extra is None else (extra.period, extra.kind)
        _add(system, names[path], component.model, period, kind, str(component.where))
    _link(system, network, faces, names)
    _set(system, network, faces, names, given(root, faces))
    _change(system, names, told)
    return system


def _names(network: Network, told: Annotated) -> dict[tuple[str, ...], str]:
    """What the instances are called: their paths, or as our annotation says."""
    renamed: dict[str, Told] = {each.element: each for each in told.instances}
    names = {path: ".".join(path) for path in network.components}
    for element, each in renamed.items():
        if element not in names.values():
            raise CosimError(f"{each.where}: {unknown('element', element, names.values())}")
    return {path: renamed[name].name if name in renamed else name for path, name in names.items()}


def _add(system: System, name: str, model: str, period: float | None, kind: Kind | None, where: str) -> None:
    try:
        system.add(name, model, period=period, kind=kind)
    except CosimError as error:
        raise CosimError(f"{where}: {error}; name one of them otherwise") from None


def _link(system: System, network: Network, faces: Mapping[str, Face], names: Mapping[tuple[str, ...], str]) -> None:
    """Links from outputs to inputs, with what becomes of values on their way."""
    for node, port, way in ends(network, faces):
        source = way[0].source
        if source.path not in network.components:
            continue
        giver, taker = (faces[network.components[path].model] for path in (source.path, node.path))
        causality = giver.ports[source.name].causality
        if causality == "output" and port.causality == "parameter":
            raise CosimError(
                f"{way[0].joint.where}: {source.text} -> {node.text}: an output cannot feed a parameter, "
                "which stays as it is while the system runs; bind a value to it"
            )
        made = carried(way, _measured(giver, source.name), _measured(taker, node.name))
        plain = made == _by_units(giver.unit(source.name), taker.unit(node.name))
        system.link((names[source.path], source.name), (names[node.path], node.name), None if plain else made)


def _by_units(unit: Unit | None, other: Unit | None) -> Transformation | None:
    """What becomes of a value where nothing but units counts; None where they do not fit."""
    try:
        return AS_IT_IS.then(conversion(unit, other, ""))
    except CosimError:
        return None


def _set(
    system: System,
    network: Network,
    faces: Mapping[str, Face],
    names: Mapping[tuple[str, ...], str],
    bound: Mapping[Node, Given],
) -> None:
    """Values before the start: those of variables, and in their place those that lead there from a system."""
    left = []
    for path, component in network.components.items():
        face, instance = faces[component.model], system.instances[names[path]]
        linked = {link.input for link in system.links if link.target == names[path]}
        values = dict(_bound(path, face, bound)) | dict(_led(path, face, network, bound))
        for name, (value, where) in values.items():
            port = face.ports[name]
            if port.causality not in _SETTABLE:
                left.append(f"{names[path]}.{name}")
            elif name not in linked:  # a value that a connection brings takes its place before the start
                instance.parameters[name] = coerce(f"{where}: {names[path]}.{name}", port, _fitting(port, value))
    if left:
        more = f" and {len(left) - 1} more" if len(left) > 1 else ""
        _LOG.warning("%s%s: start values of what is neither input nor parameter are left to the FMUs", left[0], more)


def _bound(path: tuple[str, ...], face: Face, bound: Mapping[Node, Given]) -> Iterator[tuple[str, tuple[Value, str]]]:
    """What bindings give to the variables themselves."""
    for name in face.ports:
        value = bound.get(Node(path, name))
        if value is not None:
            yield name, (value_of(value, _measured(face, name))[0], str(value.parameter.where))


def _led(
    path: tuple[str, ...], face: Face, network: Network, bound: Mapping[Node, Given]
) -> Iterator[tuple[str, tuple[Value, str]]]:
    """What bindings give to connectors of systems that lead to variables."""
    for name, port in face.ports.items():
        way: list[Edge] = network.way(Node(path, name)) if port.causality in _SETTABLE else []
        value = bound.get(way[0].source) if way else None
        if value is None or way[0].source.path in network.components:
            continue
        connector = network.connectors.get(way[0].source)
        start = Measured() if connector is None else Measured(connector.unit, connector.items)
        found, read = value_of(value, start)
        yield name, (arrived(found, read, way, port, _measured(face, name)), str(value.parameter.where))


def _change(system: System, names: Mapping[tuple[str, ...], str], told: Annotated) -> None:
    """Events, as our annotation says."""
    called = {".".join(path): name for path, name in names.items()}
    for event in told.events:
        if event.element not in called:
            raise CosimError(f"{event.where}: {unknown('element', event.element, called)}")
        system.at(event.time, f"{called[event.element]}.{event.connector}", event.value)


def _measured(face: Face, name: str) -> Measured:
    return Measured(face.unit(name), face.ports[name].items)


def _fitting(port: Port, value: Value) -> Value:
    """A number as the Boolean that a transformation made it from."""
    return bool(value) if port.type == "Boolean" and isinstance(value, float) else value
