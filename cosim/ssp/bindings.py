"""Which value every variable and connector gets from the parameter bindings of all levels (5.2.3).

Names in a binding are hierarchical: a connector of the system itself, or the name of an element, a dot, and a name in
that element. A value that nothing of that name takes is ignored, and one that several take is applied to all of them.
Of two bindings of one level the later counts, of two levels the higher.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from cosim.model.face import Face
from cosim.ssp.network import Node
from cosim.ssp.structure import Binding, Component, Entry, Parameter, Reference, Tree


@dataclass(frozen=True, slots=True)
class Given:
    """A parameter, and the entry of the mapping that gave it its name here."""

    parameter: Parameter
    entry: Entry | None = None


def given(root: Tree, faces: Mapping[str, Face]) -> dict[Node, Given]:
    """What the bindings give to variables of components and connectors of systems; `faces` are by model."""
    found: dict[Node, Given] = {}
    _collect(root, (), faces, found)
    return found


def _collect(
    element: Tree | Component, path: tuple[str, ...], faces: Mapping[str, Face], found: dict[Node, Given]
) -> None:
    """What is bound inside comes first, so that what is bound at this level takes its place."""
    if isinstance(element, Tree):
        for name, inner in element.elements.items():
            if not isinstance(inner, Reference):
                _collect(inner, (*path, name), faces, found)
    for binding in element.bindings:
        for name, value in _named(binding):
            for node in _meant(element, path, name, faces):
                found[node] = value


def _named(binding: Binding) -> Iterator[tuple[str, Given]]:
    """The values of a binding by the names they are applied to: the prefix comes before the mapping (5.2.3)."""
    parameters = {binding.prefix + parameter.name: parameter for parameter in binding.parameters}
    if binding.entries is None:
        yield from ((name, Given(parameter)) for name, parameter in parameters.items())
        return
    for entry in binding.entries:
        if entry.source in parameters:
            yield entry.target, Given(parameters[entry.source], entry)


def _meant(
    element: Tree | Component | Reference, path: tuple[str, ...], name: str, faces: Mapping[str, Face]
) -> Iterator[Node]:
    """All that the hierarchical name means in the element."""
    if isinstance(element, Component):
        if name in faces[element.model].ports:
            yield Node(path, name)
    elif isinstance(element, Tree):
        if name in element.connectors:
            yield Node(path, name)
        for inner, child in element.elements.items():
            if name.startswith(f"{inner}."):
                yield from _meant(child, (*path, inner), name[len(inner) + 1 :], faces)
