"""The connections of a tree of systems as a network: what feeds every connector, through all levels.

A node is a connector of a component or a system, or an entry of a signal dictionary, which all references share.
Start and end of a connection say nothing of its direction; the kinds of its connectors do (5.3.2, Allowed Connections).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from cosim.errors import CosimError, unknown
from cosim.model.face import Face, Port
from cosim.ssp.document import Where
from cosim.ssp.structure import Component, Connector, End, Joint, Reference, Tree

_GIVING = ("output", "calculatedParameter")
_TAKING = ("input", "parameter")
_ALIKE = ({"Integer", "Enumeration"},)
"""Types that are the same numbers."""


class Node(NamedTuple):
    """The connector `name` of the element at `path`, the names of elements from the root on."""

    path: tuple[str, ...]
    name: str

    @property
    def text(self) -> str:
        return ".".join((*self.path, self.name))


@dataclass(frozen=True, slots=True)
class Edge:
    """A connection in the direction of its values; the connectors as far as they are declared."""

    source: Node
    target: Node
    giving: Connector | None
    taking: Connector | None
    joint: Joint

    @property
    def text(self) -> str:
        return f"{self.source.text} -> {self.target.text}"


@dataclass(slots=True)
class Network:
    """All components by path, what comes into every node, and the connectors that are declared."""

    components: dict[tuple[str, ...], Component] = field(default_factory=dict)
    incoming: dict[Node, Edge] = field(default_factory=dict)
    connectors: dict[Node, Connector] = field(default_factory=dict)

    def way(self, node: Node) -> list[Edge]:
        """The connections that lead to the node, from where its value comes from; raises CosimError for a circle."""
        found: list[Edge] = []
        seen = {node}
        while node in self.incoming:
            edge = self.incoming[node]
            found.insert(0, edge)
            node = edge.source
            if node in seen:
                raise CosimError(f"{edge.joint.where}: {edge.text} closes a circle without an FMU; take one of it out")
            seen.add(node)
        return found


def networked(root: Tree, faces: Mapping[str, Face]) -> Network:
    """The network of the tree; `faces` are by model. Raises CosimError for what cannot be connected."""
    made = Network()
    _enter(made, root, (), [], faces)
    return made


def _enter(made: Network, tree: Tree, path: tuple[str, ...], above: Sequence[Tree], faces: Mapping[str, Face]) -> None:
    made.connectors |= {Node(path, name): connector for name, connector in tree.connectors.items()}
    for name, element in tree.elements.items():
        below = (*path, name)
        if isinstance(element, Tree):
            _enter(made, element, below, [*above, tree], faces)
        elif isinstance(element, Component):
            _agree(element, faces[element.model])
            made.components[below] = element
            made.connectors |= {Node(below, each): connector for each, connector in element.connectors.items()}
    for joint in tree.joints:
        edge = _directed(joint, tree, path, [*above, tree], faces)
        other = made.incoming.setdefault(edge.target, edge)
        if other is not edge:
            raise CosimError(
                f"{joint.where}: {edge.target.text} is fed twice, by {edge.source.text} and by {other.source.text} "
                f"({other.joint.where}); keep one connection"
            )


def _agree(component: Component, face: Face) -> None:
    """Raises CosimError where a declared connector is not as the variable of its name in the FMU."""
    for name, connector in component.connectors.items():
        port = face.ports.get(name)
        if port is None:
            raise _no_variable(component, name, face, connector.where)
        if connector.kind != port.causality:
            raise CosimError(
                f"{connector.where}: connector {component.name}.{name} is of kind {connector.kind}, "
                f"but in {face.model} it is {_article(port.causality)}; make the two alike"
            )
        if connector.type not in (None, port.type) and {connector.type, port.type} not in _ALIKE:
            raise CosimError(
                f"{connector.where}: connector {component.name}.{name} is {_article(str(connector.type))}, "
                f"but in {face.model} it is {_article(port.type)}; make the two alike"
            )


def _directed(
    joint: Joint, tree: Tree, path: tuple[str, ...], scopes: Sequence[Tree], faces: Mapping[str, Face]
) -> Edge:
    """The connection with its source first."""
    start, end = (_end(each, joint.where, tree, path, scopes, faces) for each in (joint.start, joint.end))
    if start.role == end.role != 0:
        both = "give values; connect one to an input" if start.role > 0 else "take values; connect one to an output"
        raise CosimError(f"{joint.where}: {joint.start} and {joint.end} both {both}")
    if start.role < 0 or end.role > 0:
        start, end = end, start
    return Edge(start.node, end.node, start.connector, end.connector, joint)


class _End(NamedTuple):
    """`role` is 1 for what gives values, -1 for what takes them, 0 for either."""

    node: Node
    connector: Connector | None
    role: int


def _end(
    end: End, where: Where, tree: Tree, path: tuple[str, ...], scopes: Sequence[Tree], faces: Mapping[str, Face]
) -> _End:
    if end.element is None:
        if end.connector not in tree.connectors:
            raise _at(where, unknown(f"connector of the system {tree.name!r}", end.connector, tree.connectors))
        connector = tree.connectors[end.connector]
        return _End(Node(path, end.connector), connector, -_role(connector.kind))
    if end.element not in tree.elements:
        raise _at(where, unknown(f"element of the system {tree.name!r}", end.element, tree.elements))
    element, below = tree.elements[end.element], (*path, end.element)
    if isinstance(element, Reference):
        return _signal(end, element, where, path, scopes)
    declared = element.connectors.get(end.connector)
    if declared is not None:
        if isinstance(element, Component):
            declared = _defined(declared, faces[element.model])
        return _End(Node(below, end.connector), declared, _role(declared.kind))
    if isinstance(element, Tree):
        raise _at(where, unknown(f"connector of the system {end.element!r}", end.connector, element.connectors))
    return _End(Node(below, end.connector), None, _role(_variable(element, end.connector, faces, where).causality))


def _defined(connector: Connector, face: Face) -> Connector:
    """The connector; a unit that its file names and does not define is that of the FMU."""
    unit = connector.unit
    if unit is None or unit.exponents is not None:
        return connector
    return replace(connector, unit=face.units.get(unit.name, unit))


def _variable(component: Component, name: str, faces: Mapping[str, Face], where: Where) -> Port:
    """The variable that a connection names though no connector is declared for it."""
    face = faces[component.model]
    if name not in face.ports or face.ports[name].causality not in (*_GIVING, *_TAKING):
        raise _no_variable(component, name, face, where)
    return face.ports[name]


def _signal(end: End, reference: Reference, where: Where, path: tuple[str, ...], scopes: Sequence[Tree]) -> _End:
    """An entry of the dictionary, which is looked up in the systems from here outwards (5.3.3)."""
    for depth in range(len(scopes) - 1, -1, -1):
        entries = scopes[depth].dictionaries.get(reference.dictionary)
        if entries is None:
            continue
        if end.connector not in entries:
            raise _at(where, unknown(f"signal of the dictionary {reference.dictionary!r}", end.connector, entries))
        connector = reference.connectors.get(end.connector, entries[end.connector])
        return _End(Node((*path[:depth], f"({reference.dictionary})"), end.connector), connector, _role(connector.kind))
    raise CosimError(
        f"{reference.where}: there is no signal dictionary {reference.dictionary!r}; {reference.name!r} wants one"
    )


def _role(kind: str) -> int:
    """Seen from the system around the element."""
    return 1 if kind in _GIVING else -1 if kind in _TAKING else 0


def _no_variable(component: Component, name: str, face: Face, where: Where) -> CosimError:
    names = [port.name for port in face.ports.values() if port.causality in (*_GIVING, *_TAKING)]
    return _at(where, unknown(f"variable of {component.name!r} ({face.model})", name, names))


def _at(where: Where, error: CosimError) -> CosimError:
    return CosimError(f"{where}: {error}")


def _article(word: str) -> str:
    return f"an {word}" if word[:1] in "aeiouIE" else f"a {word}"


def ends(made: Network, faces: Mapping[str, Face]) -> Iterator[tuple[Node, Port, list[Edge]]]:
    """Every input and parameter of a component that something leads to, with the way to it."""
    for path, component in made.components.items():
        for name, port in faces[component.model].ports.items():
            node = Node(path, name)
            if port.causality in _TAKING and node in made.incoming:
                yield node, port, made.way(node)
